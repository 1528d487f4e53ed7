"""Rays through the arena, and what each surface does to a range reading."""
