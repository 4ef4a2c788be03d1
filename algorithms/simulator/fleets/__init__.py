"""Fleets of simulated robots, and those that ship."""
