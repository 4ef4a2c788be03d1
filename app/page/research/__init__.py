"""Comparisons and sweeps on the page: two tabs beside "Stages"."""
