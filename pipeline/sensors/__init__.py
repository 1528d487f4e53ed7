"""Sensors of a user's own: their contract, a file to begin with, and the texts about all sensors."""
