"""Evidence for and against a transform, and the probability that it is right."""
