"""Comparison of the range sensor model with recordings of a real sensor."""
