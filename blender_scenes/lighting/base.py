"""The result of a kind of light: what it adds to a scene."""

from dataclasses import dataclass

from blender_scenes.scene.description import LightPanel, Mesh, Sky, Sun
from blender_scenes.scene.shading import Surface


@dataclass(frozen=True)
class Lights:
    """Lights that one kind of light adds to a scene, with their bodies and the surfaces of these."""

    panels: tuple[LightPanel, ...] = ()
    suns: tuple[Sun, ...] = ()
    skies: tuple[Sky, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    """Bodies of lamps, curtains and blinds."""
    surfaces: tuple[Surface, ...] = ()
