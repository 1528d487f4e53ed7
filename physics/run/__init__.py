"""A run of the robot: its driver, its laps and its recording."""
