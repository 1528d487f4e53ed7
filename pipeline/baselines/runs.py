"""The runs of a release or of an output of `simulate`, with the true poses that judge the methods."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from configs.schema.scenario import RunSpec
from pipeline.baselines.base import TrainingRun
from pipeline.baselines.further_sensors.readings import FurtherReadings
from pipeline.baselines.further_sensors.stereo_log import StereoLog
from pipeline.baselines.robot_knowledge import NO_FURTHER, SLIP_M_SQRT_M, RobotKnowledge, RunImages, Start
from pipeline.run_folder.stored_runs import (
    read_simulated,
    run_name,
    sensor_numbers,
    simulated_folders,
    tables_of,
)
from pipeline.run_folder.stored_spec import read_simulated_spec
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.tables.time_series import Recording
from symolo.dataset.documents.metadata import METADATA, read_metadata
from symolo.dataset.layout import SIDE, SPEC
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_tables import TOF, WHEELS
from symolo.exporters.export import open_release
from symolo.reader.run import Run


@dataclass(frozen=True)
class TrueRun:
    """What judges estimates in a run, whatever they were made from."""

    name: str
    rows: Rows
    arena: Arena
    """Shapes for the figure."""

    @property
    def t_s(self) -> Array:
        """(N,), time of each row [s]."""
        return self.rows.t_ms / 1000

    @property
    def truth(self) -> Array:
        """(N, 3), x [m], y [m], yaw [rad] in W."""
        return self.rows.pose


@dataclass(frozen=True)
class LoggedRun:
    """The tables of one run: its true poses, the readings that methods may use, and the specification of its robot."""

    name: str
    spec: RunSpec
    rows: Rows
    wheels: Array
    """Table of side/wheels.csv."""
    tof: Array
    """Table of side/tof.csv."""
    images: RunImages | None
    """Images; None before rendering."""
    further: FurtherReadings = NO_FURTHER
    """Readings of the sensors of `robot.sensors`."""

    @classmethod
    def of_recording(cls, name: str, spec: RunSpec, recording: Recording) -> "LoggedRun":
        further = FurtherReadings.from_tables(spec.robot.sensors, partial(sensor_numbers, recording))
        return cls(name, spec, *tables_of(recording), images=None, further=further)

    @property
    def truth(self) -> Array:
        """(N, 3), x [m], y [m], yaw [rad] in W."""
        return self.rows.pose

    @property
    def true_run(self) -> TrueRun:
        return TrueRun(self.name, self.rows, Arena.from_config(self.spec.arena))

    def knowledge(
        self, start_sd: Array, rng: np.random.Generator, slip_m_sqrt_m: float = SLIP_M_SQRT_M
    ) -> RobotKnowledge:
        """Return the knowledge of its robot, whose start has an error of these standard deviations (3,)."""
        start = Start(self.truth[0] + start_sd * rng.standard_normal(3), start_sd)
        return RobotKnowledge.from_tables(
            self.spec,
            self.rows,
            wheels=self.wheels,
            tof=self.tof,
            start=start,
            images=self.images,
            further=self.further,
            slip_m_sqrt_m=slip_m_sqrt_m,
        )

    def training_run(self) -> TrainingRun | None:
        """Return its images with their true poses, from which a method learns; None before rendering."""
        return TrainingRun(self.images, self.truth[self.images.rows]) if self.images else None


RunOf = TypeVar("RunOf", TrueRun, LoggedRun)


def open_runs(root: Path) -> tuple[LoggedRun, ...]:
    """Return all runs of a release, which is checked first, or of an output of `simulate`.

    Raises:
        InputError: It is neither, or it is damaged.
    """
    folders = simulated_folders(root)
    if folders and not (root / METADATA).exists():
        return tuple(
            LoggedRun.of_recording(run_name(folder), read_simulated_spec(folder / SPEC), read_simulated(folder))
            for folder in folders
        )
    return tuple(_released(run) for run in open_release(root, None).runs)


def open_true_runs(root: Path) -> tuple[TrueRun, ...]:
    """Return all runs of a release, which is checked first and may have been imported, or of an output of `simulate`.

    Raises:
        InputError: It is neither, or it is damaged.
    """
    if (root / METADATA).exists() or not simulated_folders(root):
        runs = open_release(root, None).runs
        return tuple(TrueRun(run.name, run.table, Arena.from_config(run.spec.arena)) for run in runs)
    return tuple(run.true_run for run in open_runs(root))


def is_imported(root: Path) -> bool:
    """Return whether the runs of a release were imported, so that no method can localise in them."""
    release = read_metadata(root)
    return release is not None and any(run.is_imported for run in release.runs)


def chosen(runs: Sequence[RunOf], pattern: str | None) -> tuple[RunOf, ...]:
    """Return the runs whose name matches a pattern, or all.

    Raises:
        InputError: No run matches.
    """
    matches = tuple(run for run in runs if pattern is None or fnmatchcase(run.name, pattern))
    if not matches:
        names = ", ".join(run.name for run in runs[:5])
        raise InputError("--runs", got=pattern, allowed=f"a pattern of names such as {names}")
    return matches


def _released(run: Run) -> LoggedRun:
    spec = read_simulated_spec(run.folder / SIDE / SPEC)
    wheels, tof = (run.side(table.file.partition(".")[0]).to_numpy(float) for table in (WHEELS, TOF))
    rows = np.flatnonzero(run.table.image)
    numbers = run.table.image[rows].tolist()
    images = RunImages(rows, lambda index: run.image(numbers[index]).pixels()) if numbers else None
    further = FurtherReadings.from_tables(
        spec.robot.sensors, lambda table: run.sensors[table.name].numbers, StereoLog.from_run(run)
    )
    return LoggedRun(run.name, spec, run.table, wheels, tof, images, further)
