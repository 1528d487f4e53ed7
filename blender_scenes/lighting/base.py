"""What a kind of light adds to a scene."""

from dataclasses import dataclass

from blender_scenes.description import Panel, Sky, Sun


@dataclass(frozen=True)
class Lights:
    panels: tuple[Panel, ...] = ()
    suns: tuple[Sun, ...] = ()
    skies: tuple[Sky, ...] = ()
