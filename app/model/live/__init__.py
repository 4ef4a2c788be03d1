"""What the page holds of robots that run."""
