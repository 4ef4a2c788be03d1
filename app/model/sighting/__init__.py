"""From a camera image and a laser scan to a sighting: what was loaded, how to look, what is said of it."""
