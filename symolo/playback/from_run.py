"""Playback of a run of a dataset: everything that its tables and the metadata name."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import cycle

import numpy as np

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.layout import SIDE, SPEC
from symolo.dataset.tables.column import Series
from symolo.dataset.tables.rows import COLUMNS, HEADER, LINE, RANGES
from symolo.dataset.tables.side_tables import SideTable
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from symolo.pages.states import Dash
from symolo.playback.playback import (
    Beam,
    CameraTrack,
    CurvePlot,
    Playback,
    PlottedCurve,
    RobotOutline,
    Scan,
    StripePlot,
)
from symolo.reader.run import Run
from symolo.reader.run_folder import RunFolder
from symolo.reader.sensor import RunSensor

MAX_CURVES = 6
"""Columns of one unit and table that are drawn as curves; more are drawn as a strip of greys."""
_RANGE_NAMES = ("front", "left", "right")
"""Directions of the range sensors, in the order of their columns."""
_SAME_TIME_S = 1e-6
"""Rounding errors of times, within which a reading belongs to a row."""
_DASHED: Dash = (0, (4.0, 1.5))
_DOTTED: Dash = (0, (1.0, 1.0))
_STYLES: tuple[tuple[str, Dash], ...] = (
    (BLACK, "-"),
    (BLUE, _DASHED),
    (VERMILION, _DOTTED),
    (GREEN, "-"),
    (ORANGE, _DASHED),
    (PURPLE, "-"),
    (SKY, "-"),
    (GREY, _DASHED),
)


def playback_of(run: Run) -> Playback:
    """Return what is shown of a run; images are read when they are needed.

    Raises:
        InputError: A file of the run is missing or damaged.
    """
    rows, spec = run.table, _spec(run)
    ranges_m = np.where(rows.tof_m == _no_target_m(spec), np.nan, rows.tof_m)
    further = _further_beams(run)
    return Playback(
        name=run.name,
        t_s=run.t_s,
        pose=rows.pose,
        state=rows.state,
        arena=Arena.from_config(spec.arena) if spec else None,
        robot=_outline(spec),
        beams=(*_beams(spec, ranges_m), *further),
        scans=tuple(_scans(run)),
        plots=(*_data_plots(run, ranges_m, further), *_sensor_plots(run)),
        cameras=_cameras(run),
    )


def has_specification(run: Run) -> bool:
    """Return whether a run has a specification, without which its cameras, robot and arena are not known."""
    return (run.folder / SIDE / SPEC).exists()


def _spec(run: Run) -> RunDocument | None:
    """Return the specification of a run; None for one that never had any."""
    return run.spec if has_specification(run) else None


def _no_target_m(spec: RunDocument | None) -> float:
    """Return the reading of a range sensor without a target, with the digits of data.csv."""
    return round(spec.robot.tof.no_target_m, COLUMNS[HEADER.index("d_f")].decimals) if spec else np.nan


def _outline(spec: RunDocument | None) -> RobotOutline:
    if spec is None:
        return RobotOutline()
    chassis, drive = spec.robot.chassis, spec.robot.drive
    return RobotOutline(chassis.length_m, chassis.width_m, drive.track_m, drive.wheel_diameter_m)


def _beams(spec: RunDocument | None, ranges_m: Array) -> tuple[Beam, ...]:
    if spec is None:
        return ()
    mounts = spec.robot.tof.mounts
    places = (mounts.front, mounts.left, mounts.right)
    return tuple(
        Beam(column.name, place.x_m, place.y_m, float(np.radians(place.yaw_deg)), range_m, colour)
        for column, place, range_m, (colour, _) in zip(RANGES.columns, places, ranges_m.T, _STYLES, strict=False)
        if np.isfinite(range_m).any()
    )


def _further_beams(run: Run) -> tuple[Beam, ...]:
    """Return the further sensors with one range, such as an ultrasonic one, with their last reading at each row.

    The range is 0 where there was no target.
    """
    beams = []
    for sensor, (colour, _) in zip(filter(_has_one_range, run.sensors.values()), cycle(_STYLES[len(_RANGE_NAMES) :])):
        last = np.searchsorted(sensor.t_s, run.t_s + _SAME_TIME_S, side="right") - 1
        read_m = sensor.values("range")[np.maximum(last, 0)] if len(sensor.t_s) else np.zeros(len(run.t_s))
        range_m = np.where((last >= 0) & (read_m > 0.0), read_m, np.nan)
        place = sensor.settings
        beams.append(Beam(sensor.name, place.x_m, place.y_m, float(np.radians(place.yaw_deg)), range_m, colour))
    return tuple(beams)


def _has_one_range(sensor: RunSensor) -> bool:
    return any(column.name == "range" and column.count == 1 for column in sensor.side_table.columns)


def _data_plots(run: Run, ranges_m: Array, further: Sequence[Beam]) -> Iterator[CurvePlot | StripePlot]:
    """Yield the plots of the columns of data.csv: speeds or else coordinates, ranges, line sensor.

    Ranges of further sensors are in the plot of the ranges too, so that a video with few plots shows them.
    """
    rows, t_s, names = run.table, run.t_s, set(run.table.columns)
    units = {column.name: column.unit for column in COLUMNS}
    if not names & {"v", "w"}:  # of an imported trajectory, the coordinates are what there is to see
        yield curve_plot("position", units["x"], t_s, ["x", "y"], rows.pose[:, :2])
        yield curve_plot("heading", units["theta"], t_s, ["theta"], rows.pose[:, 2:])
    for i, (name, title) in enumerate((("v", "forward speed v"), ("w", "yaw rate w"))):
        if name in names:
            yield curve_plot(title, units[name], t_s, [name], rows.twist[:, i : i + 1])
    if names & set(_names(RANGES)):
        every_m = np.column_stack([ranges_m, *(beam.range_m for beam in further)])
        curves = (*_RANGE_NAMES, *(beam.name.replace("_", " ") for beam in further))
        yield replace(curve_plot("range", RANGES.unit, t_s, curves, every_m), from_zero=True)
    if names & set(_names(LINE)):
        yield StripePlot("line sensor", "", t_s, _names(LINE), rows.line)


def _names(series: Series) -> tuple[str, ...]:
    return tuple(column.name for column in series.columns)


def _sensor_plots(run: Run) -> Iterator[CurvePlot | StripePlot]:
    """Yield plots of the robot's further sensors: one for each unit, and one for each group of numbered columns."""
    for sensor in run.sensors.values():
        title = sensor.name.replace("_", " ")
        for unit, names in _by_unit(sensor.side_table).items():
            values = np.column_stack([sensor.values(name) for name in names])
            if len(names) <= MAX_CURVES:
                yield curve_plot(title, unit, sensor.t_s, names, values)
            else:
                yield StripePlot(title, unit, sensor.t_s, tuple(names), _levels(values))
        for column in sensor.side_table.columns[1:]:
            if column.count > 1:
                names = tuple(map(str, range(column.count)))
                levels = _levels(sensor.values(column.name))
                yield StripePlot(f"{title} {column.name}", _unit(column.unit), sensor.t_s, names, levels)


def _by_unit(table: SideTable) -> dict[str, list[str]]:
    """Return the names of the single columns after the time, by their unit."""
    names: dict[str, list[str]] = {}
    for column in table.columns[1:]:
        if column.count == 1:
            names.setdefault(_unit(column.unit), []).append(column.name)
    return names


def _unit(unit: str) -> str:
    """Return a unit for a label, which is empty for a number without one."""
    return "" if unit == "-" else unit


def _scans(run: Run) -> Iterator[Scan]:
    """Yield the sensors of kind lidar; their ranges are 0 where a ray had no return."""
    for sensor in run.sensors.values():
        settings = sensor.settings.model_extra or {}
        if sensor.kind == "lidar" and {"first_ray_deg", "ray_step_deg"} <= settings.keys():
            range_m = sensor.values("range").reshape(len(sensor.t_s), -1)
            rays_deg = settings["first_ray_deg"] + settings["ray_step_deg"] * np.arange(range_m.shape[1])
            angles_rad = np.radians(sensor.settings.yaw_deg + rays_deg)
            seen_m = np.where(range_m > 0, range_m, np.nan)
            yield Scan(sensor.name, sensor.settings.x_m, sensor.settings.y_m, angles_rad, sensor.t_s, seen_m)


def _levels(values: Array) -> Array:
    """Return values from 0 for the smallest to 1 for the largest; NaN where nothing was measured."""
    if not np.isfinite(values).any():
        return values
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return (values - low) / (high - low) if high > low else np.full_like(values, 0.5)


def curve_plot(title: str, unit: str, t_s: Array, names: Sequence[str], values: Array) -> CurvePlot:
    """Return a plot with a curve for each column of values (M, columns)."""
    styled = zip(names, values.T, cycle(_STYLES), strict=False)
    return CurvePlot(title, unit, t_s, tuple(PlottedCurve(name, column, *style) for name, column, style in styled))


def _cameras(run: Run) -> tuple[CameraTrack, ...]:
    """Return the camera of data.csv and the further ones, as far as they have images."""
    tracks = [_camera("camera", run)] if run.numbers else []
    if _spec(run) is not None:
        further = ((name, camera) for name, camera in run.cameras.items() if camera.folder.is_dir())
        tracks += [_camera(name, camera) for name, camera in further]
    return tuple(tracks)


def _camera(name: str, run: RunFolder) -> CameraTrack:
    try:
        width_px, height_px = run.camera.width_px, run.camera.height_px
    except InputError:  # such as of a dataset without side tables
        height_px, width_px = run.images[0].pixels().shape[:2]
    return CameraTrack(name, width_px, height_px, run.images)
