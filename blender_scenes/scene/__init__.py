"""The scene of a run as data: meshes, surfaces, lights and their assembly."""
