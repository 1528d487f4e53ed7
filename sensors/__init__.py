"""Sensors: line sensor, time-of-flight sensors, encoders, pose log, odometry, and sensors from files of the user."""

SENSORS = ("line_sensor", "tof", "encoders", "pose_log")
"""Modules with one sensor each, in the order in which sensors sample if several of them do so at the same instant."""
