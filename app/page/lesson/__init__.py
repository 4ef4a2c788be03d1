"""The lesson: the whole method step by step on the loaded pair; and the museum of failures."""
