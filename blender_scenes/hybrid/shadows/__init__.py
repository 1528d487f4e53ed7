"""Shadows of what moves, by its outlines, and the light that is left in them."""
