"""A simulator of robots that map buildings: sample maps with a truth, bit for bit the same anywhere.

    building -> planner -> tours -> drive -> scan -> map;  two drives -> meeting -> case -> files

``simulate`` is the way in; ``samples`` holds what ships.
"""
