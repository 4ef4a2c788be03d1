"""Prints what each benchmark notes beside its seconds: ratios, sizes, stages."""

from __future__ import annotations


def pytest_terminal_summary(terminalreporter, config):
    session = getattr(config, "_benchmarksession", None)
    for entry in session.benchmarks if session else ():
        notes = ", ".join(
            f"{key} {value:.3g}" if isinstance(value, float) else f"{key} {value}"
            for key, value in entry.extra_info.items()
        )
        if notes:
            terminalreporter.write_line(f"{entry.name}: median {entry.stats.median * 1000:.2f} ms; {notes}")
