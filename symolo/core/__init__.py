"""Foundations of every package: errors, atomic file writing, random streams, strict YAML, progress."""
