"""Any number of robots: their pairs, the consistent set of what is found of them, and one map of all."""
