"""Robots that run, as the page follows them: simulated ones, and those of a network."""
