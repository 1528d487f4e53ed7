"""The only place that imports bpy; it is run as a process (`python -m blender_scenes.blender_side`), never imported."""
