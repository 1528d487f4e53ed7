"""Validation experiments with the line sensor."""
