"""Finding a robot in an image and in a laser scan: the front end of section III-A."""
