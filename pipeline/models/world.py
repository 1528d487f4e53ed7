"""The arena as SDF 1.9, a world of Gazebo: floor, line, walls and obstacles at t = 0, alone or with the robot."""

from collections.abc import Iterator
from itertools import pairwise
from math import atan2, ceil, hypot, radians
from xml.etree import ElementTree as ET

import numpy as np

from configs.schema.scenario import RunSpec
from physics.robot.body_inertia import GRAVITY_M_S2
from physics.robot.links import BoxShape
from pipeline.models.colours import colours
from pipeline.models.geometry import Placement
from pipeline.models.robot import RobotParts
from pipeline.models.sdf import (
    FLOOR_BIT,
    WALLS_BIT,
    add_geometry,
    add_material,
    add_surface,
    robot_model,
)
from pipeline.models.sdf_elements import add_pose, child, document
from sensors.camera.colour import RGB
from sensors.inertial.imu import ImuSettings
from symolo.arena.geometry import Arc, Arena, Box, Chain, Straight

LINE_HEIGHT_M = 0.0005
"""Height of the line on the floor: so low that it does not matter, so high that viewers do not flicker."""
_CHORD_M = 0.01
_FRICTION = 1.0
"""Friction of floor, walls and obstacles: contacts have the friction of the robot, whether an engine multiplies both
or takes the smaller one."""
_SYSTEMS = (
    ("gz-sim-physics-system", "gz::sim::systems::Physics", {}),
    ("gz-sim-user-commands-system", "gz::sim::systems::UserCommands", {}),
    ("gz-sim-scene-broadcaster-system", "gz::sim::systems::SceneBroadcaster", {}),
    ("gz-sim-sensors-system", "gz::sim::systems::Sensors", {"render_engine": "ogre2"}),
)
_SUN = {
    "pose": (0, 0, 10, 0, 0, 0),
    "diffuse": (0.9, 0.9, 0.9, 1),
    "specular": (0.1, 0.1, 0.1, 1),
    "direction": (-0.4, 0.3, -0.9),
    "cast_shadows": "true",
}
"""A light so that something is visible; the light of the look belongs to the images."""


def arena_sdf(spec: RunSpec) -> bytes:
    """Return a world with the arena only."""
    return document(_world(spec))


def world_sdf(spec: RunSpec, parts: RobotParts) -> bytes:
    """Return a world with the arena and with the robot at the start of the run."""
    world = _world(spec)
    if any(isinstance(settings, ImuSettings) for _, settings in spec.robot.sensors):
        child(world, "plugin", filename="gz-sim-imu-system", name="gz::sim::systems::Imu")
    start = spec.start
    world.append(robot_model(parts, Placement((start.x_m, start.y_m, 0.0), (0.0, 0.0, radians(start.yaw_deg)))))
    return document(world)


def _world(spec: RunSpec) -> ET.Element:
    arena, colour = Arena.from_config(spec.arena), colours(spec)
    world = ET.Element("world", name=arena.name)
    steps = {"max_step_size": 1 / spec.rates.physics_hz, "real_time_factor": 1}
    child(world, "physics", steps, name="as_simulated", type="ignored")
    child(world, "gravity", (0, 0, -GRAVITY_M_S2))
    for filename, name, settings in _SYSTEMS:
        child(world, "plugin", settings, filename=filename, name=name)
    child(world, "light", _SUN, name="sun", type="directional")
    _floor(world, arena, colour["floor"])
    if arena.line.pieces:
        _line(world, arena, [colour[f"{spec.look.line}_{number}"] for number in range(len(arena.line.strips))])
    for box in arena.boxes:
        _box(world, box, colour[f"{box.kind}_{box.name}"])
    return world


def _fixed(world: ET.Element, name: str, placement: Placement) -> ET.Element:
    model = child(world, "model", name=name)
    child(model, "static", "true")
    add_pose(model, placement)
    return child(model, "link", name="link")


def _floor(world: ET.Element, arena: Arena, srgb: RGB) -> None:
    link = _fixed(world, "floor", Placement())
    size = (2 * arena.floor_half_extent_m,) * 2
    for tag in ("collision", "visual"):
        element = child(link, tag, name=tag)
        child(element, "geometry", {"plane": {"normal": (0, 0, 1), "size": size}})
        if tag == "collision":
            add_surface(element, FLOOR_BIT, _FRICTION)
        else:
            add_material(element, srgb)


def _line(world: ET.Element, arena: Arena, srgb: list[RGB]) -> None:
    """Add flat boxes on the floor without collision; an arc consists of chords, because PyBullet reads no polyline.

    `srgb` has the colour of each strip.
    """
    link = _fixed(world, "line", Placement())
    strips = arena.line.strips
    piece_colors = [
        srgb[i] for i, strip in enumerate(strips) for _ in (strip.pieces if isinstance(strip, Chain) else (0,))
    ]
    for number, (piece, color) in enumerate(zip(arena.line.pieces, piece_colors, strict=True)):
        for part, (placement, length_m) in enumerate(_chords(piece, arena.line.width_m)):
            visual = child(link, "visual", name=f"piece_{number}_{part}")
            add_pose(visual, placement)
            add_geometry(visual, BoxShape((length_m, arena.line.width_m, LINE_HEIGHT_M)))
            add_material(visual, color)


def _chords(piece: Straight | Arc, width_m: float) -> Iterator[tuple[Placement, float]]:
    """Yield placement and length [m] of each chord; they overlap so that no wedge is open on the outside of a bend."""
    count = 1 if isinstance(piece, Straight) else ceil(piece.length_m / _CHORD_M)
    ends = piece.at(np.linspace(0.0, piece.length_m, count + 1))
    longer = 1.0 + 0.5 * width_m * abs(piece.curvature_per_m)
    for begin, end in pairwise(ends):
        (x, y), (dx, dy) = (0.5 * (begin + end)).tolist(), (end - begin).tolist()
        yield Placement((x, y, 0.5 * LINE_HEIGHT_M), (0.0, 0.0, atan2(dy, dx))), longer * hypot(dx, dy)


def _box(world: ET.Element, box: Box, srgb: RGB) -> None:
    link = _fixed(world, f"{box.kind}_{box.name}", Placement(box.center, (0.0, 0.0, box.yaw_rad)))
    for tag in ("collision", "visual"):
        element = child(link, tag, name=tag)
        add_geometry(element, BoxShape(box.size))
        if tag == "collision":
            add_surface(element, WALLS_BIT, _FRICTION)
        else:
            add_material(element, srgb)
