"""Stages that predict readings of range sensors, and what the sensors see."""
