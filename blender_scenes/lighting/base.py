"""What a kind of light adds to a scene."""

from dataclasses import dataclass

from blender_scenes.description import Panel, Portal, Sky, Sun


@dataclass(frozen=True)
class Lights:
    panels: tuple[Panel, ...] = ()
    portals: tuple[Portal, ...] = ()
    suns: tuple[Sun, ...] = ()
    skies: tuple[Sky, ...] = ()
