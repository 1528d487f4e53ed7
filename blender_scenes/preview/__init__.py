"""The scene without Blender: rasterised in numpy, with direct light and flat colours, through the same camera.

It is independent of Blender, so that a comparison of both shows whether a scene is where its description puts it.
"""
