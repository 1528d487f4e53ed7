"""Inertial measurement units and the errors of their axes."""
