"""Sensors: those that every robot has, those of `robot.sensors`, odometry, and sensors from files of the user."""

SENSORS = (
    "line.line_sensor",
    "ranging.tof",
    "wheels.encoders",
    "pose_log",
    "inertial.imu",
    "ranging.lidar",
    "ranging.vl53l0x",
    "ranging.ultrasonic",
    "line.line_array",
    "wheels.wheel_encoder",
    "bumper",
    "camera.further_camera",
)
"""Modules with one sensor each, in the order in which sensors sample if several of them do so at the same instant."""
