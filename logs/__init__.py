"""Logs of other programs: their columns and units, mapping files, and the trajectories in them."""
