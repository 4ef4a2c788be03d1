"""The pictures of the page: one file each."""
