"""Pictures of a line by a camera with something hidden, made by supersampling; shares no code with the packages."""

from picture_cases.scene import Camera, Hidden, Lens, picture, poses, track_yaml

__all__ = ["Camera", "Hidden", "Lens", "picture", "poses", "track_yaml"]
