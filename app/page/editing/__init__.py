"""Observations and transforms that a person sets by hand."""
