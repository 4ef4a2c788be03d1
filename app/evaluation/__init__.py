"""Data sets, comparison of methods, parameter sweeps, and their figures."""
