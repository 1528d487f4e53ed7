"""Measurements at the wheels and motors: encoders, their odometry, and instruments of a motor bench."""
