"""Hybrid rendering: an image assembled from light maps and separately traced parts."""
