"""Robot and arena of a run as model files for other people's tools: URDF and SDF."""
