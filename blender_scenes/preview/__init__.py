"""The scene seen without Blender: rasterised in numpy, lit directly by cosine, in flat colours, the same camera.

A second, independent observer of the description: what both see in the same place is where the scene is.
"""
