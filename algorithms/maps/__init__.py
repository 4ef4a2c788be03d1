"""The grid map, the merged map, and the distance to the nearest wall."""
