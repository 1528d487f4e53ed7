"""Strict YAML, whose values remember where they were written."""
