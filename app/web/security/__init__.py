"""Who may connect, and what a browser may send."""
