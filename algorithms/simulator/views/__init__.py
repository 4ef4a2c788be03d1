"""Pictures and scans that a robot takes of another one in a simulated building, with the truth."""
