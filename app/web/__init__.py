"""The viser server, uploads, downloads, and events of the browser."""
