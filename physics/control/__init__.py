"""Controllers of the robot: the built-in one (line, wall, corner, avoidance and lost behaviour), and those of users."""

CONTROLLERS = ("built_in", "program")
"""Modules of this package with a controller, one class each."""
