"""All that a tab holds as a file: written, read, and kept on the disk of the server."""
