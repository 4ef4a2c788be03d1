"""What a building looks like inside: walls, doors, furniture, where one can stand."""
