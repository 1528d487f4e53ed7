"""Localisation with the sensors of `robot.sensors`: an IMU, a lidar, and a pair of cameras."""
