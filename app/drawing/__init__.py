"""Colours and pixels: grids in, pictures out."""
