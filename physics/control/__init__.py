"""What the robot decides: line, wall, corner, avoidance and lost behaviour at the control rate."""
