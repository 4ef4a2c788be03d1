"""What leaves the page: the result's files, and the frame of the merged map in them."""
