"""What one robot saw of another, and the window for the transform that it leaves."""
