"""Sensors: line sensor, time-of-flight sensors, encoders, pose log, odometry, and those of files of the user."""

SENSORS = ("line_sensor", "tof", "encoders", "pose_log")
"""Modules with one sensor each, in the order in which sensors of the same instant sample."""
