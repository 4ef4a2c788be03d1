"""The images of maps and cameras: what their files hold, as pixels."""
