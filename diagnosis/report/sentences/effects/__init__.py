"""Sentences about single effects: those that are named, those that were tried, and a law that was discovered."""
