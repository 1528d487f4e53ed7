"""side/scene.json: what a run's scene has beyond its look, drawn by a seed of the run's own."""

import json
from pathlib import Path
from typing import Any

from pydantic_core import to_jsonable_python

from blender_scenes.lighting.flicker import mains_phase_rad
from blender_scenes.rooms.base import Furnishing
from blender_scenes.scene.run_scene import room_around
from configs.schema.arena import ArenaConfig
from configs.schema.look import LookConfig
from symolo.arena.geometry import Arena
from symolo.dataset.layout import SIDE
from symolo.dataset.metadata import Record
from symolo.dataset.side_reading import read_record

SCENE = "scene.json"
_DECIMALS = 6
"""Of all numbers: micrometres and microradians."""


class PieceRecord(Record):
    """A piece of furniture; one that found no free place is not there."""

    name: str
    """Its kind and its number among the kind's, from 0."""
    x_m: float
    y_m: float
    """Of the middle of the ground that it takes; of what hangs, of its middle on the wall's face."""
    yaw_rad: float
    """From +x of W to its width; its back is 90 deg further."""
    size_m: tuple[float, float]
    """Width and depth of that ground, as seen from its front; of what hangs, twice as deep as it comes out."""
    z_m: tuple[float, float]
    """Lowest and highest point."""
    numbers: dict[str, Any]
    """What was drawn for it, by the names of its kind; a colour is reflectance, hue_deg, saturation."""

    @classmethod
    def of(cls, piece: Furnishing) -> "PieceRecord":
        x, y, yaw = piece.pose
        place = {"x_m": x, "y_m": y, "yaw_rad": yaw, "size_m": piece.size_m, "z_m": piece.height_m}
        told = {"name": piece.name, **place, "numbers": piece.numbers}
        return cls.model_validate(_rounded(to_jsonable_python(told)))


class SceneRecord(Record):
    """The content of scene.json."""

    seed: int
    """Of patterns, stains, dust, wear, lifted edges, the spread of paint, and noise; more of them is not told."""
    mains_phase_rad: float
    """Lamps that flicker shine as 1 + depth cos(4 pi mains_hz t + this), t from the run's start."""
    furniture: tuple[PieceRecord, ...]

    @classmethod
    def of(cls, arena: ArenaConfig, look: LookConfig, seed: int) -> "SceneRecord":
        """Of the scene that these give; the seed is that of the run's pictures."""
        pieces = room_around(Arena.from_config(arena), look, seed).furniture
        phase = round(mains_phase_rad(seed), _DECIMALS)
        return cls(seed=seed, mains_phase_rad=phase, furniture=tuple(PieceRecord.of(piece) for piece in pieces))

    def to_json(self) -> bytes:
        """A line for each piece."""
        pieces = [json.dumps(piece.model_dump(mode="json"), sort_keys=True) for piece in self.furniture]
        listed = "[\n    " + ",\n    ".join(pieces) + "\n  ]" if pieces else "[]"
        head = f'"mains_phase_rad": {json.dumps(self.mains_phase_rad)},\n  "seed": {self.seed}'
        return f'{{\n  "furniture": {listed},\n  {head}\n}}\n'.encode()


def scene_file(arena: ArenaConfig, look: LookConfig, seed: int) -> tuple[str, bytes]:
    """The file by its path in the folder of the pictures."""
    return f"{SIDE}/{SCENE}", SceneRecord.of(arena, look, seed).to_json()


def read_scene_record(path: Path) -> SceneRecord:
    """What `to_json` wrote.

    Raises:
        OSError: There is no such file.
        ValueError: It is damaged; the text is one line.
    """
    return read_record(path, SceneRecord)


def _rounded(value: Any) -> Any:  # noqa: ANN401 - plain JSON
    if isinstance(value, dict):
        return {key: _rounded(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(inner) for inner in value]
    return round(value, _DECIMALS) + 0.0 if isinstance(value, float) else value
