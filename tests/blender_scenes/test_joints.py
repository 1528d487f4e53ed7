"""Place, width, depth and colour of the joints of floors and brickwork, from their settings.

The expressions are evaluated in Python here: noises and random numbers have their mean, and tiles follow the formula of
Blender's brick texture, which `blender_side/test_shaders.py` compares with Cycles.
"""

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from blender_scenes.materials import FLOORS, SURFACES
from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import (
    Arithmetic,
    Cells,
    Color,
    Constant,
    Expression,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Tiles,
)
from configs.schema.appearance.floors import FloorLook
from configs.schema.appearance.look import LookConfig
from sensors.camera.colour import paint_rgb

PAGE = (Path(__file__).parents[2] / "docs/looks.md").read_text()
JOINT = {"reflectance": 0.15, "hue_deg": 120, "saturation": 0.5}
FLOOR = FloorLook.model_validate(
    {
        "ceramic_tile": {"size_m": 0.3, "joint_width_m": 0.02, "joint": JOINT},
        "parquet": {"plank_length_m": 0.4, "plank_width_m": 0.1, "gap_m": 0.008},
        "plywood": {"sheet_length_m": 0.5, "sheet_width_m": 0.3, "seam_m": 0.008},
        "paper_sheets": {"sheet_length_m": 0.5, "sheet_width_m": 0.4, "tape_width_m": 0.05},
        "carpet": {"tile_size_m": 0.25, "loop_m": 0.02},
        "vinyl": {"repeat_m": 0.06},
    }
)
LOOK = LookConfig.model_validate(
    {"name": "wide", "brick": {"length_m": 0.2, "height_m": 0.08, "joint_m": 0.02, "joint": JOINT}}
)


@dataclass(frozen=True)
class Joints:
    """What the settings above ask for; the numbers that are not settings are those of docs/looks.md."""

    pitch_m: tuple[float, float]
    """Distance from the middle of one joint to that of the next, along u and v."""
    width_m: float
    """Width of all that is coloured."""
    stagger: float
    """Shift between a row and the next, in tile lengths."""
    depth_m: float
    """Depth in the middle of the joint, below the middle of the tile."""


JOINTS = {
    "ceramic_tile": Joints((0.3, 0.3), 0.02, stagger=0.0, depth_m=0.0012),
    "parquet": Joints((0.4, 0.1), 0.008, stagger=0.37, depth_m=0.0003),
    "plywood": Joints((0.5, 0.3), 0.008 + 0.006, stagger=0.5, depth_m=0.0016),
    "paper_sheets": Joints((0.5, 0.4), 0.05, stagger=0.35, depth_m=0.0),
    "carpet": Joints((0.25, 0.25), 0.6 * 0.02, stagger=0.0, depth_m=0.4 * 0.02),
    "vinyl": Joints((6.5 * 0.06, 0.06), 0.002, stagger=0.31, depth_m=0.0),
    "brick": Joints((0.22, 0.1), 0.02, stagger=0.5, depth_m=0.004),
}
WITHOUT_JOINTS = {"linoleum", "concrete", "image"}
STEPS = 16
"""Number of points across a joint."""


def _surface(name: str) -> Surface:
    patch = SurfacePatch(name, (5.0, 5.0), 1)
    return FLOORS[name](FLOOR, patch) if name in FLOORS else SURFACES[name](LOOK, patch)


def _value(texture: Expression, u_m: np.ndarray, v_m: np.ndarray, clouds: float = 0.5) -> np.ndarray:
    """Return a texture at points (H, W) as (H, W, 3), or in a shape that is broadcast to this.

    Args:
        texture: What is evaluated.
        u_m: Coordinates along u.
        v_m: Coordinates along v.
        clouds: Value of all noises whose features are larger than 1 cm.
    """

    def at(inner: Expression) -> np.ndarray:
        return _value(inner, u_m, v_m, clouds)

    match texture:
        case Constant(value) | Color(value):
            return np.broadcast_to(np.array(value), (1, 1, 3))
        case NoiseTexture() | Cells() | Tiles(value="random"):
            return np.full((1, 1, 1), clouds if _is_cloud(texture) else 0.5)
        case Tiles():
            return _joint(texture, u_m, v_m)[..., None]
        case SurfaceCoordinate(axis):
            return {"u": u_m, "v": v_m}[axis][..., None]
        case Step(of, low, high):
            return _smooth((at(of) - low) / (high - low))
        case Mix(by, a, b):
            share = np.clip(at(by), 0.0, 1.0)
            return (1 - share) * at(a) + share * at(b)
        case Arithmetic("sine", a):
            return np.sin(at(a))
        case Arithmetic(operation, a, b):
            return getattr(np, operation)(at(a), at(b))
    raise TypeError(type(texture))


def _is_cloud(texture: Expression) -> bool:
    return isinstance(texture, NoiseTexture) and max(texture.per_m) < 100


def _joint(tiles: Tiles, u_m: np.ndarray, v_m: np.ndarray) -> np.ndarray:
    """Return `svm_brick` of Cycles (intern/cycles/kernel/svm/brick.h) at points (H, W)."""
    (width, height), half = tiles.size_m, 0.5 * tiles.joint_m
    u, v = u_m + tiles.offset_m[0], v_m + tiles.offset_m[1]
    u = u + np.where(np.floor(v / height) % 2 == 0, tiles.stagger * width, 0.0)
    from_middle = np.minimum(np.minimum(u % width, -u % width), np.minimum(v % height, -v % height))
    return _smooth((1 - from_middle / half) / tiles.softness) if half else np.zeros_like(u_m)


def _smooth(share: np.ndarray) -> np.ndarray:
    share = np.clip(share, 0.0, 1.0)
    return share * share * (3 - 2 * share)


@dataclass(frozen=True)
class Lines:
    """The joints of one floor or wall along lines through three rows and three tile lengths."""

    surface: Surface
    joints: Joints
    step_m: float
    """Distance between neighbouring points of a line."""
    rows: list[np.ndarray]
    """Places v of the points in each joint between two rows [m]."""
    row_joints: list[list[np.ndarray]]
    """Places u of the points in each joint within a row [m], for each row between two of the joints above."""

    @property
    def tile(self) -> tuple[float, float]:
        """The middle of a tile of the first row."""
        return float(self.row_joints[0][0].mean()) + 0.5 * self.joints.pitch_m[0], self.row_middle_m(0)

    def row_middle_m(self, number: int) -> float:
        return 0.5 * float(self.rows[number][-1] + self.rows[number + 1][0])

    def height_m(self, u_m: object, v_m: object) -> np.ndarray:
        height = self.surface.height_m
        return np.zeros(1) if height is None else _at(height, u_m, v_m)[..., 0]


def _at(texture: Expression, u_m: object, v_m: object, clouds: float = 0.5) -> np.ndarray:
    """Return a texture at points (H, W), given in shapes that are broadcast to this, as (H, W, C)."""
    u_m, v_m = np.broadcast_arrays(np.atleast_2d(u_m), np.atleast_2d(v_m))
    value = _value(texture, u_m, v_m, clouds)
    return np.broadcast_to(value, (*u_m.shape, value.shape[-1]))


def _lines(name: str) -> Lines:
    surface, joints = _surface(name), JOINTS[name]
    step_m = joints.width_m / STEPS
    along_u, along_v = (np.arange(0.0, 3.4 * pitch_m, step_m) for pitch_m in joints.pitch_m)
    few_u = np.linspace(0.0, joints.pitch_m[0], 16, endpoint=False)

    grid = _at(surface.base_color, few_u[None], along_v[:, None])
    values, counts = np.unique(grid.round(9).reshape(-1, 3), axis=0, return_counts=True)
    tile = values[counts.argmax()]
    rows = _spans(_differs(grid, tile).all(axis=1), along_v)
    middles_m = [0.5 * (below[-1] + above[0]) for below, above in pairwise(rows)]
    row_joints = [_spans(_differs(_at(surface.base_color, along_u, v_m), tile)[0], along_u) for v_m in middles_m]
    return Lines(surface, joints, step_m, rows, row_joints)


def _differs(color: np.ndarray, tile: np.ndarray) -> np.ndarray:
    return np.abs(color - tile).max(axis=-1) > 1e-6


def _spans(inside: np.ndarray, at_m: np.ndarray) -> list[np.ndarray]:
    """Return the places of each run of true values that has an end on both sides."""
    cuts = np.flatnonzero(np.diff(inside)) + 1
    return [run for run, first in zip(np.split(at_m, cuts)[1:-1], cuts, strict=False) if inside[first]]


@pytest.fixture(scope="module", params=JOINTS)
def lines(request) -> Lines:
    return _lines(request.param)


def test_every_floor_has_its_joints_checked_or_has_none():
    assert set(JOINTS) - {"brick"} | WITHOUT_JOINTS == set(FLOORS)


def test_joints_are_as_wide_as_their_settings_say(lines):
    every = [*lines.rows, *(joint for row in lines.row_joints for joint in row)]
    assert len(every) >= 3 + 2 * 2
    widths_m = [len(joint) * lines.step_m for joint in every]
    assert widths_m == pytest.approx([lines.joints.width_m] * len(every), abs=1.5 * lines.step_m)


def test_joints_are_as_far_apart_as_their_settings_say(lines):
    u_m, v_m = lines.joints.pitch_m
    for pitch_m, joints in ((v_m, lines.rows), *((u_m, row) for row in lines.row_joints)):
        distances_m = np.diff([joint.mean() for joint in joints])
        assert distances_m == pytest.approx(np.full(len(joints) - 1, pitch_m), abs=1.5 * lines.step_m)


def test_rows_are_staggered_only_where_the_material_is_laid_so(lines):
    pitch_m = lines.joints.pitch_m[0]
    one_m, other_m = (row[0].mean() for row in lines.row_joints[:2])
    shift = min((one_m - other_m) % pitch_m, (other_m - one_m) % pitch_m) / pitch_m
    assert shift == pytest.approx(lines.joints.stagger, abs=1.5 * lines.step_m / pitch_m)


def test_joints_are_as_deep_as_the_page_says(lines):
    u_m, v_m = lines.tile
    tile_m = float(lines.height_m(u_m, v_m).max())
    for joint_m in (lines.height_m(lines.row_joints[0][0], v_m), lines.height_m(u_m, lines.rows[0])):
        assert tile_m - joint_m.min() == pytest.approx(lines.joints.depth_m, rel=0.03, abs=1e-9)


@pytest.mark.parametrize("name", ["ceramic_tile", "brick"])
def test_the_middle_of_a_joint_has_the_colour_of_its_setting(name):
    lines = _lines(name)
    seen = _at(lines.surface.base_color, lines.tile[0], lines.rows[0].mean())
    assert seen.ravel() == pytest.approx(paint_rgb(FLOOR.ceramic_tile.joint))


def test_patches_of_dirt_make_a_joint_darker_by_the_share_that_the_page_says():
    lines = _lines("ceramic_tile")
    clean, dirty = (
        _at(lines.surface.base_color, lines.tile[0], lines.rows[0].mean(), clouds).ravel() for clouds in (0.5, 1.0)
    )
    (percent,) = re.findall(r"Patches of dirt make the joints of ceramic tiles up to (\d+) %", PAGE)
    assert 1 - dirty / clean == pytest.approx(np.full(3, 0.01 * int(percent)), abs=0.005)


def test_the_page_has_the_depths_that_are_checked_here():
    depths_mm = dict(re.findall(r"^\| \[`(\w+)`].* \| ([\d.]+)(?: mm|;)? ?.*\|$", PAGE, re.MULTILINE))
    assert {name: float(text) for name, text in depths_mm.items() if name != "carpet"} == {
        name: pytest.approx(1000 * JOINTS[name].depth_m) for name in set(JOINTS) - {"brick", "carpet"}
    }
    assert "| 0.4 times `carpet.loop_m` |" in PAGE
