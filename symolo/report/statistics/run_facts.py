"""Facts of each run that the page shows, small enough to be in memory for all runs."""

from dataclasses import dataclass, replace

import numpy as np

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.codes import State
from symolo.dataset.documents.metadata import RunRecord
from symolo.dataset.tables.rows import Ints
from symolo.reader.run import Run
from symolo.reader.sensor import RunSensor
from symolo.report.statistics.off_line import ahead_of, off_line_m


@dataclass(frozen=True)
class RunPath:
    """The path of a run, for the map."""

    pose: Array
    """(N, 3), x [m], y [m], theta [rad] in W."""
    state: Ints
    """(N,), codes of the states."""


@dataclass(frozen=True)
class RunFacts:
    """The facts of one run that the page shows."""

    record: RunRecord
    arena: Arena
    drawn: dict[str, float | int | str | bool]
    farthest_following_m: float | None
    """Largest distance [m] of the line sensor's middle from the line's middle while the robot follows the line; None if
    the robot never follows it."""
    images: tuple[tuple[int, int, float], ...]
    """Number, state and time [s] of each image."""
    path: RunPath | None
    """Path for the map; None if this run is not on a map."""
    sensor_limits: tuple[Array, ...]
    """Smallest and largest value (2, columns) of each table of the sensors of `robot.sensors`, without the time."""

    @property
    def source_route(self) -> str:
        """Route of the run whose trajectory it has: that of the release that was rendered again, if it was."""
        release = self.record.origin.release if self.record.origin else None
        return self.route if release is None else release.run.rpartition("/test_")[0]

    @property
    def route(self) -> str:
        return self.record.run.partition("/")[0]


def run_facts(run: Run, record: RunRecord, *, with_path: bool) -> RunFacts:
    """Return the facts of one run; its tables do not stay in memory.

    Raises:
        InputError: A file of the run is missing or damaged.
    """
    run = fresh(run)
    rows, spec = run.table, run.spec
    arena = Arena.from_config(spec.arena)
    following = (rows.state == State.LINE.value) & bool(arena.line.pieces)
    off_m = off_line_m(arena.line, ahead_of(rows.pose[following], spec.robot.line_sensor.x_m))
    taken = run.image_table
    return RunFacts(
        record=record,
        arena=arena,
        drawn=dict(spec.drawn),
        farthest_following_m=float(off_m.max()) if len(off_m) else None,
        images=tuple(
            zip(
                taken.image.tolist(),
                taken.state.tolist(),
                (taken.t_ms / 1000).tolist(),
                strict=True,
            )
        ),
        path=RunPath(rows.pose, rows.state) if with_path else None,
        sensor_limits=tuple(_limits(sensor) for sensor in run.sensors.values()),
    )


def _limits(sensor: RunSensor) -> Array:
    """Return the smallest and the largest value of each column, (2, columns); NaN where nothing was measured."""
    values = [sensor.values(column.name) for column in sensor.side_table.columns[1:]]
    known = [one[np.isfinite(one)] for one in values]
    return np.array([[limit(one) if one.size else np.nan for one in known] for limit in (np.min, np.max)])


def fresh(run: Run) -> Run:
    """Return the same run without the tables that it has read, so that they are freed together with the result."""
    return replace(run)
