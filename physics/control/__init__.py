"""The controller of the robot: line, wall, corner, avoidance and lost behaviour at the control rate."""
