"""A run of the robot: the runner of its controller, and the end of a lap."""
