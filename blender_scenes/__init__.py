"""Images: scenes as data, materials, light, camera, and the Blender process that renders them."""
