"""``python -m app``: the same as ``mapmeld``."""

from app.cli import entry

if __name__ == "__main__":
    entry()
