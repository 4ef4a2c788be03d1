"""Comparisons and sweeps on the page: two tabs beside "Stages", over app/contest.py and app/sweep.py."""
