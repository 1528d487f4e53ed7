"""Readers of the trajectories in logs: one file for each kind of log."""
