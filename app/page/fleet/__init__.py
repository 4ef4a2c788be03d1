"""A fleet of robots in place of two maps."""
