"""Measurements in images: edges, levels, sharpness and noise."""
