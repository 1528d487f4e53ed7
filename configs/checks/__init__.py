"""Checks over several fields: impossible geometry, and settings that contradict each other."""
