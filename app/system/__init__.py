"""The machine and what is installed: version, memory, processors, log, shipped files."""
