"""Robots that run, on the page: their maps grow, and are merged meanwhile."""
