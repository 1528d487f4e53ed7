"""Random arenas that a robot can lap: a closed line, walls around it, boxes on it and beside it, checked for room."""
