"""A run as one HTML page that plays offline: recorded from the same pictures and words as the page's."""
