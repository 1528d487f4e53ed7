"""Render jobs, the Blender child process that does them, and the files that it leaves."""
