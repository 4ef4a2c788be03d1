"""A simulator of robots that map buildings."""
