"""Images of a line by a camera with something hidden, made by supersampling; shares no code with the packages."""

from camera_cases.scene import Camera, Hidden, Lens, image, poses, track_yaml

__all__ = ["Camera", "Hidden", "Lens", "image", "poses", "track_yaml"]
