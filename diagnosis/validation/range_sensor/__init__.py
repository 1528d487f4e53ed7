"""Validation experiments with the range sensor: the five of the paper (section 5.2), and recordings."""
