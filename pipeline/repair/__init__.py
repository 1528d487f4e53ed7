"""Damaged files of a release made again, and nothing else: `symolo repair`."""
