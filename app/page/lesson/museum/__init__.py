"""The museum of failures: pairs that the method, set in a certain way, gets wrong, and their cures."""
