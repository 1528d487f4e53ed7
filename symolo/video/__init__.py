"""Runs as a video: camera, floor, states and readings over time."""
