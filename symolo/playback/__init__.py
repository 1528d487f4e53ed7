"""A run over time: what the view in a browser and the video show of it."""
