"""CSV exports of OptiTrack's Motive: rigid bodies with rotation X Y Z W and position X Y Z, y up.

Seven lines stand above the numbers: the settings of the export, an empty line, and for each column the type, the name
and the ID of its object, the kind of its value, and its axis (https://docs.optitrack.com, Data Export: CSV).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from logs.axis import Axis
from logs.recognition import first_line
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from symolo.core.errors import InputError, nearest
from symolo.core.files.text_file import TextFile, read_text
from symolo.core.geometry.poses import rotations
from symolo.core.progress import plural
from symolo.core.tables.table import number

_PER_M = {"Meters": 1.0, "Centimeters": 100.0, "Millimeters": 1000.0}
_TYPE, _NAME, _KIND, _AXIS = "Type", "Name", "Rotation", "Frame"
_PARTS = (*(("Rotation", axis) for axis in "XYZW"), *(("Position", axis) for axis in "XYZ"))


@dataclass(frozen=True)
class _Body:
    name: str
    columns: tuple[int, ...]
    """Column of each of `_PARTS`."""
    unit: str
    """Unit of its positions."""


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    text = read_text(path)
    heading = text.lines[0].split(",")
    about = dict(zip(heading[::2], heading[1::2], strict=False))
    if (rotation := about.get("Rotation Type", "")) != "Quaternion":
        cure = "export the take again with Rotation: Quaternion"
        raise InputError("Rotation Type", where=f"{path}: row 1", got=rotation, allowed="Quaternion", cure=cure)
    if (unit := about.get("Length Units", "")) not in _PER_M:
        raise InputError("Length Units", where=f"{path}: row 1", got=unit, allowed=", ".join(_PER_M))
    start = next((i for i, line in enumerate(text.lines) if line.startswith(f"{_AXIS},Time")), None)
    if start is None:
        raise InputError("has no line that begins with Frame,Time", where=str(path), cure="export with the header")
    bodies = _bodies(text, start, unit)
    chosen = bodies
    if settings.topics:
        names = [body.name for body in bodies]
        for name in settings.topics:
            if name not in names:
                hint = nearest(name, names)
                raise InputError("--topic", got=name, allowed=", ".join(names), nearest=hint)
        chosen = [body for body in bodies if body.name in settings.topics]
    return [_trajectory(text, start, body, settings) for body in chosen]


def _bodies(text: TextFile, start: int, unit: str) -> list[_Body]:
    """Return the rigid bodies of a take.

    Raises:
        InputError: There is none.
    """
    above = [line.split(",") for line in text.lines[:start]]
    types, names = (next((row for row in above if len(row) > 1 and row[1] == title), []) for title in (_TYPE, _NAME))
    kinds = next((row for row in above if _KIND in row), [])
    axes = text.lines[start].split(",")
    columns: dict[str, dict[tuple[str, str], int]] = {}
    for i in range(2, min(len(types), len(names), len(kinds), len(axes))):
        if types[i].strip('"') == "Rigid Body":
            columns.setdefault(names[i].strip('"'), {})[kinds[i], axes[i]] = i
    bodies = [
        _Body(name, tuple(places[part] for part in _PARTS), unit)
        for name, places in columns.items()
        if all(part in places for part in _PARTS)
    ]
    if not bodies:
        cure = "export the take again with Rigid Bodies"
        raise InputError("has no rigid body with rotation and position", where=str(text.path), cure=cure)
    return bodies


def _trajectory(text: TextFile, start: int, body: _Body, settings: ReadSettings) -> LoggedTrajectory:
    rows, lost = [], 0
    for row, line in enumerate(text.lines[start + 1 :], start + 2):
        cells = line.split(",")
        if len(cells) <= max(body.columns) or not all(cells[i].strip() for i in body.columns):
            lost += bool(line.strip())
            continue
        where = f"{text.path}: row {row}"
        rows.append([number(cells[i], f"{i + 1}", where) for i in (1, *body.columns)])
    if len(rows) < 2:
        raise InputError(f"the body {body.name} is not tracked in two rows", where=str(text.path))
    table = np.array(rows)
    t_s, quaternion, p_OB = table[:, 0], table[:, 1:5], table[:, 5:8] / _PER_M[body.unit]
    if np.any(np.diff(t_s) <= 0.0):
        raise InputError("the times do not increase", where=str(text.path), cure="export the take again")
    up = settings.up or Axis.Y
    floor = on_floor(p_OB, rotations(quaternion), str(text.path), up=up, forward=settings.forward)
    quantities = {"t": "Time (Seconds)", **floor.quantities, "body": f"{body.name}, in {body.unit}"}
    changes = [f"left out: {plural(lost, 'row')} in which {body.name} was not tracked"] if lost else []
    return LoggedTrajectory(
        t_s.copy(),
        floor.pose,
        quantities,
        changes=(*text.notes, *changes, *floor.changes),
        guesses=floor.guesses,
        warnings=floor.warnings,
        name=body.name,
    )


READER = TrajectoryReader(
    "motive",
    "a CSV export of OptiTrack's Motive",
    lambda path: path.suffix.lower() == ".csv" and first_line(path).startswith("FormatVersion,"),
    _read,
)
