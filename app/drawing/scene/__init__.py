"""What is drawn into viser's scene: one file each."""
