"""Logs as runs of a dataset: where they lie, with which robot and look their images would be rendered."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from configs.draw import draw_arena, draw_look, draw_render, draw_robot
from configs.loader import LoadedSection, load_scenario, load_section
from configs.robot_sensors import IS_LOGGED, RobotSensors, UnloadedSettings
from configs.schema.arena import ArenaConfig
from configs.schema.scenario import SceneSpec, StartPose
from logs.trajectories.base import LoggedCamera, ReadSettings
from pipeline.importing.cameras import camera_content, camera_settings, image_times, left_out_images
from pipeline.importing.floor import MAX_HALF_EXTENT_M, fitting_floor, middle_of
from pipeline.importing.log_files import ReadLog, read_logs
from pipeline.importing.rows import ImportedRows, ImportedTable, imported_rows
from pipeline.run_warnings.imported_trajectory import check_possible, trajectory_warnings
from pipeline.stages.run_tables import ExternalRun
from pipeline.stages.simulate_runs import RunOutcome
from symolo.core.arrays import Array
from symolo.core.errors import FaultList, InputError
from symolo.dataset.documents.origin import Origin
from symolo.dataset.layout import DATA, SIDE
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.sensor_tables import ListedSensor

DEFAULT_SCENARIO = "symolo"
"""The scenario whose image settings, and whose arena for its own data.csv, an imported trajectory has by default."""
DEFAULT_LOOK, DEFAULT_ROBOT = "classroom", "nominal"
ROUTE = "imported"
UNKNOWN_LICENCE = "NOASSERTION"
"""Value of SPDX documents for a licence that nobody has stated."""
_MAX_NAME = 64


@dataclass(frozen=True)
class ImportRequest:
    """The options of `symolo import`."""

    paths: tuple[Path, ...]
    format: str | None = None
    settings: ReadSettings = field(default_factory=ReadSettings)
    row_hz: float | None = None
    arena: str | None = None
    robot: str | None = None
    route: str = ROUTE
    name: str | None = None
    licence: str = UNKNOWN_LICENCE
    seed: int = 1
    with_images: bool = False
    """Whether the column `img` of a data.csv says at which rows images are to be taken."""


@dataclass(frozen=True)
class ImportedDataset:
    """The runs of a dataset that are not written yet."""

    runs: tuple[ExternalRun, ...]
    tree: dict[str, Any]
    """Sections of a scenario, for metadata.json."""
    assets: Mapping[str, Path]
    """Paths of the user's files that the look names, by SHA-256."""
    sensors: tuple[ListedSensor, ...]
    """Sensors whose tables in `side/` have the further columns of the logs."""
    logs: tuple[ReadLog, ...]


@dataclass(frozen=True)
class _Placed:
    """The tables of a log with its place in W."""

    log: ReadLog
    imported: ImportedRows
    changes: tuple[str, ...]


def imported_dataset(request: ImportRequest) -> ImportedDataset:
    """Read logs and return them as runs; nothing is written.

    Raises:
        InputError: A log cannot be read, or gives no motion on a floor; all such logs are reported.
    """
    logs = _all_read(request)
    robot_section = load_section("robot", request.robot or DEFAULT_ROBOT)
    look_section = load_section("look", DEFAULT_LOOK)
    robot, robot_drawn = draw_robot(robot_section, request.seed, request.route, 1)
    placed, arena, arena_tree = _placed(logs, request, robot.tof.no_target_m)
    sensors = tuple(ListedSensor(one.kind, one.table) for one in _common_tables(placed))
    render = draw_render(load_scenario(DEFAULT_SCENARIO), request.seed, request.route, 1)
    name = request.name or _name_of(logs)
    runs = []
    for number, each in enumerate(placed, 1):
        look, look_drawn = draw_look(look_section, request.seed, request.route, number)
        cameras = () if request.with_images else each.log.trajectory.cameras
        notes = left_out_images(cameras, each.imported.rows, float(each.log.trajectory.t_s[0]))
        origin = Origin(log=each.log.origin.model_copy(update={"changes": (*each.changes, *notes)}))
        spec = SceneSpec(
            scenario=name,
            seed=request.seed,
            route=request.route,
            run=number,
            start=_start(each.imported.rows),
            render=render,
            arena=arena,
            robot=robot.model_copy(update={"sensors": _logged(each)}),
            look=look,
            origin=origin,
            drawn=dict(sorted({**robot_drawn, **look_drawn}.items())),  # type: ignore[arg-type]
        )
        runs.append(_taken(spec, each, cameras))
    sections = {"arena": arena_tree, "robot": robot_section.tree, "look": look_section.tree}
    tree = {
        "name": name,
        "description": f"Trajectories of {', '.join(dict.fromkeys(log.origin.file for log in logs))}",
        "seed": request.seed,
        "licence": request.licence,
        **sections,
    }
    return ImportedDataset(tuple(runs), tree, look_section.assets, sensors, tuple(logs))


def _all_read(request: ImportRequest) -> list[ReadLog]:
    faults, logs = FaultList(), []
    for path in request.paths:
        with faults.noted():
            logs += read_logs([path], request.format, request.settings)
    faults.check()
    return logs


def _placed(
    logs: Sequence[ReadLog], request: ImportRequest, no_target_m: float
) -> tuple[list[_Placed], ArenaConfig, dict[str, Any]]:
    """Return the tables of all logs, the arena in which they lie, and its settings."""
    faults, placed = FaultList(), []
    for log in logs:
        with faults.noted():
            _check_possible(log)
            imported = imported_rows(
                log.trajectory, log.title, no_target_m, request.row_hz, with_images=request.with_images
            )
            placed.append(_Placed(log, imported, (*log.origin.changes, *imported.changes)))
    faults.check()
    is_symolo = all(log.origin.format == "symolo" for log in logs)
    places = [each.imported.rows.pose[:, :2] for each in placed]
    if request.arena or (is_symolo and not _is_far(places)):
        _check_reach(placed)
        section = load_section("arena", request.arena or DEFAULT_SCENARIO)
        arena = _drawn_arena(section, request, placed[0].imported.rows)
        return placed, arena, section.tree
    shift = middle_of(places)
    if _is_far(places) and any(shift):
        placed = [_moved(each, shift) for each in placed]
    whole = np.concatenate([each.imported.rows.pose[:, :2] for each in placed])
    arena = fitting_floor(whole, placed[0].log.title if len(placed) == 1 else "all logs together")
    return placed, arena, arena.model_dump(mode="json")


def _check_possible(log: ReadLog) -> None:
    trajectory, is_symolo = log.trajectory, log.origin.format == "symolo"
    if len(trajectory.t_s) > 1:
        at = (lambda row: f"{log.title}:{row + 2}") if is_symolo else (lambda _row: log.title)
        check_possible(trajectory.t_s, trajectory.pose, at, in_milliseconds=is_symolo)


def _check_reach(placed: Sequence[_Placed]) -> None:
    """Refuse paths that no arena can hold, where an arena is named.

    Raises:
        InputError: A path is too far away from the origin.
    """
    for each in placed:
        reach_m = float(np.abs(each.imported.rows.pose[:, :2]).max())
        if reach_m > MAX_HALF_EXTENT_M:
            raise InputError(
                f"the path is up to {reach_m:.4g} m away from the origin",
                where=each.log.title,
                allowed=f"{MAX_HALF_EXTENT_M:g} m",
                cure="give x and y in metres, or leave out --arena: the path is then moved to a floor that fits it",
            )


def _drawn_arena(section: LoadedSection, request: ImportRequest, rows: Rows) -> ArenaConfig:
    x_m, y_m, yaw_rad = rows.pose[0].tolist()
    return draw_arena(section, request.seed, request.route, 1, start=(x_m, y_m, yaw_rad))[0]


def _is_far(places: Sequence[Array]) -> bool:
    """Return whether a path is farther from the origin than it is wide, or beyond the largest floor."""
    whole = np.concatenate(places)
    reach_m, width_m = float(np.abs(whole).max()), float(np.ptp(whole, axis=0).max())
    return reach_m > 45.0 or reach_m > 10.0 + 2.0 * width_m


def _moved(each: _Placed, shift: tuple[float, float]) -> _Placed:
    rows = each.imported.rows
    table = rows.table().copy()
    table[:, [rows.columns.index("x"), rows.columns.index("y")]] -= shift
    moved = Rows.from_table(np.round(table, 9), rows.columns)
    x_m, y_m = (0.0 - part for part in shift)
    text = f"x and y are moved by ({x_m:g}, {y_m:g}) m, so that the middle of all paths is the origin"
    imported = ImportedRows(moved, each.imported.tables, each.imported.changes)
    return _Placed(each.log, imported, (*each.changes, text))


def _common_tables(placed: Sequence[_Placed]) -> tuple[ImportedTable, ...]:
    """Return the tables that all runs have.

    Raises:
        InputError: Two logs have different columns, which one dataset cannot describe.
    """
    first, *others = placed
    tables = first.imported.tables
    for other in others:
        same = [_form(table) for table in other.imported.tables] == [_form(table) for table in tables]
        if not same or other.imported.rows.columns != first.imported.rows.columns:
            raise InputError(
                "has other columns than the first log",
                where=other.log.title,
                got=[*other.imported.rows.columns, *(one.table.name for one in other.imported.tables)],
                allowed=", ".join([*first.imported.rows.columns, *(one.table.name for one in tables)]),
                cure="import it into a dataset of its own",
            )
    return tables


def _form(one: ImportedTable) -> tuple[str, str, tuple[str, ...]]:
    """Return what a dataset describes once for all its runs."""
    return one.kind, one.table.name, one.table.header


def _logged(each: _Placed) -> RobotSensors:
    """Return the sensors of an imported run: those of the log in the place of those of the robot."""
    settings = {
        one.table.name: UnloadedSettings.model_validate({"kind": one.kind, IS_LOGGED: True, **one.settings})
        for one in each.imported.tables
    }
    return RobotSensors(tuple(sorted(settings.items(), key=lambda member: member[0])))


def _start(rows: Rows) -> StartPose:
    x_m, y_m, yaw_rad = rows.pose[0].tolist()
    return StartPose(x_m=x_m, y_m=y_m, yaw_deg=math.degrees(yaw_rad))


def _taken(spec: SceneSpec, each: _Placed, cameras: Sequence[LoggedCamera]) -> ExternalRun:
    rows, trajectory = each.imported.rows, each.log.trajectory
    start_s = float(trajectory.t_s[0])
    seen = {camera.name: camera for camera in cameras if image_times(camera, rows, start_s)[0]}
    settings = {name: UnloadedSettings.model_validate(camera_settings(camera)) for name, camera in seen.items()}
    sensors = sorted([*spec.robot.sensors, *settings.items()], key=lambda member: member[0])
    robot = spec.robot.model_copy(update={"sensors": RobotSensors(tuple(sensors))})
    spec = spec.model_copy(update={"robot": robot})
    warnings = (*trajectory.warnings, *trajectory_warnings(trajectory.t_s, trajectory.pose))
    outcome = RunOutcome.of_rows(rows, suspicions=warnings)
    side = {f"{SIDE}/{one.table.file}": one.table.to_csv(one.numbers) for one in each.imported.tables}
    side |= dict(camera_content(spec, rows, seen, start_s))
    return ExternalRun(spec, rows, side, outcome)


def _name_of(logs: Sequence[ReadLog]) -> str:
    """Return a name for a dataset of these logs, of the letters that a name may have."""
    path = logs[0].path.absolute()
    stem = path.parent.name if path.name == DATA else path.stem  # a data.csv is named by its folder
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in stem).strip("-")
    return plain[:_MAX_NAME] or "imported"
