"""Faults of a released dataset that can be found from its folder alone."""
