"""Sensors: those that every robot has, those of `robot.sensors`, odometry, and sensors from files of the user."""

SENSORS = (
    "line_sensor",
    "tof",
    "encoders",
    "pose_log",
    "imu",
    "lidar",
    "vl53l0x",
    "ultrasonic",
    "line_array",
    "wheel_encoder",
    "bumper",
    "further_camera",
)
"""Modules with one sensor each, in the order in which sensors sample if several of them do so at the same instant."""
