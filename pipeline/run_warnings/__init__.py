"""Warnings of a run: a probable mistake in its scenario, a range that was left, or an implausible imported path."""
