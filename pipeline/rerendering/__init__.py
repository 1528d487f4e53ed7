"""New images for stored trajectories."""
