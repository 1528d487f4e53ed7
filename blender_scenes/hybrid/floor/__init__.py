"""The floor of hybrid images: which of its points are seen, and the maps of its light, relief and layers."""
