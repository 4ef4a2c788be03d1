"""Figures for reports and papers, as PNG and SVG. matplotlib is loaded here and nowhere else."""
