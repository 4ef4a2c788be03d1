"""Robots that run: their maps and poses as they are published, and one map of them that grows."""
