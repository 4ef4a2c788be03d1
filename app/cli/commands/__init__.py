"""The commands of the command line, a file each: ``USAGE``, ``DESCRIPTION``, ``add_arguments``, ``run``.

``add_arguments`` tells the parser what the command takes; where it takes the settings of a method, these
depend on the method in ``words``. ``run`` gives the exit status.
"""
