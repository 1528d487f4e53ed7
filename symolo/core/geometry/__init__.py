"""Poses in the plane and in space, the pinhole camera and its lens."""
