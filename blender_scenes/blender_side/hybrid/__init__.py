"""The Blender side of hybrid rendering."""
