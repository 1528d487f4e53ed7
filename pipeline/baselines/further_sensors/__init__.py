"""Localisation with the sensors of `robot.sensors`: an IMU and a lidar."""
