"""side/scene.json: the parts of a run's scene that are not in its look; they are drawn with the seed of the run."""

import json
from pathlib import Path
from typing import Any

from symolo.dataset.documents.record import Record
from symolo.dataset.tables.side_reading import read_record

SCENE = "scene.json"


class PieceRecord(Record):
    """A piece of furniture; pieces for which there was no free place are left out."""

    name: str
    """Kind of the piece, and its number among the pieces of this kind, from 0."""
    x_m: float
    y_m: float
    """Middle of the floor area that the piece covers; of a hanging piece, its middle on the face of the wall."""
    yaw_rad: float
    """Angle from +x of W to the width of the piece; its back is 90 deg further."""
    size_m: tuple[float, float]
    """Width and depth of that area, as seen from the front; a hanging piece counts as twice as deep as it is."""
    z_m: tuple[float, float]
    """Lowest and highest point."""
    numbers: dict[str, Any]
    """Drawn values of the piece, by the names of its kind; a colour is reflectance, hue_deg, saturation."""


class SceneRecord(Record):
    """The content of scene.json."""

    seed: int
    """Seed of patterns, stains, dust, wear, lifted edges, the spread of paint, and noise."""
    mains_phase_rad: float
    """Lamps that flicker shine as 1 + depth cos(4 pi mains_hz t + this), t from the run's start."""
    furniture: tuple[PieceRecord, ...]

    def to_json(self) -> bytes:
        """Return the text of the file, with a line for each piece."""
        pieces = [json.dumps(piece.model_dump(mode="json"), sort_keys=True) for piece in self.furniture]
        listed = "[\n    " + ",\n    ".join(pieces) + "\n  ]" if pieces else "[]"
        head = f'"mains_phase_rad": {json.dumps(self.mains_phase_rad)},\n  "seed": {self.seed}'
        return f'{{\n  "furniture": {listed},\n  {head}\n}}\n'.encode()


def read_scene_record(path: Path) -> SceneRecord:
    """Return what `to_json` wrote.

    Raises:
        OSError: There is no such file.
        ValueError: It is damaged; the text is one line.
    """
    return read_record(path, SceneRecord)
