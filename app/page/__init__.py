"""One tab of the browser."""
