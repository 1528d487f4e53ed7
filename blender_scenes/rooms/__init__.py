"""The room around the arena: walls, window and furniture."""
