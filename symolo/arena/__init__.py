"""The geometry of an arena: line, walls, obstacles and their motion."""
