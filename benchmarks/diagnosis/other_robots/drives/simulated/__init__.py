"""A robot that drives through a room, its readings, and what is wrong with them."""
