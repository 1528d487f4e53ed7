"""Short forms in an arena file, polygons of walls and a line through points, which are replaced on loading."""
