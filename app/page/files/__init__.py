"""Maps and what is known of them: from a sample, or from a person's own files."""
