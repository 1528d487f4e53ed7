"""A slow random error of a range sensor, and what it can be confused with."""
