"""A sighting from robot 1's camera and laser scan: its files, what is found in them, the one that is used."""
