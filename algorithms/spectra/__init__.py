"""Augmented maps, their spectra, and the candidates for the transform that these give."""
