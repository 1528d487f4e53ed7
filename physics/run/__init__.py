"""A run of the robot: who drives it, and its laps."""
