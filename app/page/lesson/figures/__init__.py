"""The pictures of the lesson: what a run found out, drawn as SVG; no server, no scene."""
