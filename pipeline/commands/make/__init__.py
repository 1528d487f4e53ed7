"""Commands that make data: stages of a dataset, import, new images, descriptions of robots and arenas, effects."""
