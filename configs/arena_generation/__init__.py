"""Random arenas with enough room for a lap: a closed line, walls around it, and boxes on it and next to it."""
