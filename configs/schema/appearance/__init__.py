"""Sections of a look: floor, line, walls, room, light and camera response."""
