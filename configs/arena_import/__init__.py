"""Arenas from drawings: SVG files and images of floor plans."""
