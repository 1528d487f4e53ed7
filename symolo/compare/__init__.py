"""Comparison of two sets of files: `symolo compare`."""
