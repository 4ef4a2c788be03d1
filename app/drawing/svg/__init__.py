"""What is drawn as SVG; no server, no scene."""
