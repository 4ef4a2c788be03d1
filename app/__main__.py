"""``python -m app``: the same as ``mapmeld``."""

from app.cli.main import entry

if __name__ == "__main__":
    entry()
