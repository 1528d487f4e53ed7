"""Localisation with a network that is trained on a release: images and ranges to a heat map over poses."""
