"""Strict YAML scenarios, their schema, and the draws that turn distributions into numbers."""
