"""Validation experiments with the motor."""
