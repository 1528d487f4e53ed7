"""The geometry of the arena: line, walls, obstacles and their motion, rays and surfaces."""
