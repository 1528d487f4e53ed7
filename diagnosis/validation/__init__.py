"""Benches: a part of the robot alone, measured in the simulation as on a table, beside what is known of it."""
