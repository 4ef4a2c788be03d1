"""The sensors of a robot that sees another one: a camera and a laser scanner."""
