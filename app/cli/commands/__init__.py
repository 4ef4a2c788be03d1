"""The commands of the command line, a file each: ``USAGE``, ``DESCRIPTION``, ``add_arguments``, ``run``."""
