"""Sentences about the measured data, and about what is fitted with the robot and is no part of it."""
