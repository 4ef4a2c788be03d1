"""The buildings that are simulated: one kind a file."""
