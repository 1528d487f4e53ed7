"""Writes side/scene.json: the furniture of a run's scene, the phase of its mains, and its seed."""

from typing import Any

from pydantic_core import to_jsonable_python

from blender_scenes.lighting.flicker import mains_phase_rad
from blender_scenes.rooms.base import Furnishing
from blender_scenes.scene.run_scene import room_around
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from symolo.arena.geometry import Arena
from symolo.dataset.documents.scene_record import SCENE, PieceRecord, SceneRecord
from symolo.dataset.layout import SIDE

_DECIMALS = 6
"""Decimals of all numbers: micrometres and microradians."""


def scene_file(arena: ArenaConfig, look: LookConfig, seed: int) -> tuple[str, bytes]:
    """Return path and content of scene.json; `seed` is that of the run's images."""
    pieces = room_around(Arena.from_config(arena), look, seed).furniture
    phase = round(mains_phase_rad(seed), _DECIMALS)
    record = SceneRecord(seed=seed, mains_phase_rad=phase, furniture=tuple(_piece_record(piece) for piece in pieces))
    return f"{SIDE}/{SCENE}", record.to_json()


def _piece_record(piece: Furnishing) -> PieceRecord:
    x, y, yaw = piece.pose
    place = {"x_m": x, "y_m": y, "yaw_rad": yaw, "size_m": piece.size_m, "z_m": piece.height_m}
    fields = {"name": piece.name, **place, "numbers": piece.numbers}
    return PieceRecord.model_validate(_rounded(to_jsonable_python(fields)))


def _rounded(value: Any) -> Any:  # noqa: ANN401 - plain JSON
    if isinstance(value, dict):
        return {key: _rounded(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(inner) for inner in value]
    return round(value, _DECIMALS) + 0.0 if isinstance(value, float) else value
