"""The table of methods, the default method stage by stage, and merging by hand."""
