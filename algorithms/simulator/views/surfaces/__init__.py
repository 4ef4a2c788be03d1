"""What things look like: materials, and the patterns of floors, walls and furniture."""
