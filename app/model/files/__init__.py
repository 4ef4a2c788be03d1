"""Files that a person brings: what each is, what it is for, and what they make up."""
