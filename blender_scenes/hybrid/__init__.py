"""Hybrid rendering: images from maps of the floor, light of few samples, and separately traced surfaces."""
