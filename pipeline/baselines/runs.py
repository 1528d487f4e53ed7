"""The runs of a release or of an output of `simulate`, with the true poses that judge the methods."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from pydantic import ValidationError

from configs.schema.scenario import RunSpec
from pipeline.assembly.run_spec import read_run_spec
from pipeline.baselines.base import TrainingRun
from pipeline.baselines.robot_knowledge import RobotKnowledge, RunImages, Start
from pipeline.stages.simulate_runs import TRAJECTORY, read_recording
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.time_series import Recording
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import SPEC, STAGES
from symolo.dataset.tables.rows import HEADER, Rows, parse_table
from symolo.dataset.tables.side_tables import TOF, WHEELS, tof_csv, wheels_csv
from symolo.exporters.export import open_release
from symolo.reader.run import Run


@dataclass(frozen=True)
class LoggedRun:
    name: str
    spec: RunSpec
    rows: Rows
    wheels: Array
    """Table of side/wheels.csv."""
    tof: Array
    """Table of side/tof.csv."""
    pictures: RunImages | None
    """Images; None before rendering."""

    @classmethod
    def of_recording(cls, name: str, spec: RunSpec, recording: Recording) -> "LoggedRun":
        """Return the run, rounded through text so that it is the same before and after its release."""
        rows = parse_table(Rows.from_recording(recording).to_csv(), HEADER)[0]
        wheels = parse_table(wheels_csv(recording), WHEELS.header)[0]
        tof = parse_table(tof_csv(recording), TOF.header)[0]
        return cls(name, spec, Rows.from_table(rows), wheels, tof, None)

    @property
    def truth(self) -> Array:
        """(N, 3), x [m], y [m], yaw [rad] in W."""
        return self.rows.pose

    def knowledge(self, start_sd: Array, rng: np.random.Generator) -> RobotKnowledge:
        """Return the knowledge of its robot, whose start has an error of these standard deviations (3,)."""
        start = Start.drawn(self.truth[0], start_sd, rng)
        return RobotKnowledge.of(
            self.spec, self.rows, wheels=self.wheels, tof=self.tof, start=start, pictures=self.pictures
        )

    def lesson(self) -> TrainingRun | None:
        """Return its images with their true poses for other runs to learn from."""
        return TrainingRun(self.pictures, self.truth[self.pictures.rows]) if self.pictures else None


def open_runs(root: Path) -> tuple[LoggedRun, ...]:
    """Return all runs of a release, which is checked first, or of an output of `simulate`.

    Raises:
        InputError: It is neither, or it is damaged.
    """
    folders = sorted(path.parent for path in root.glob(f"{STAGES}/simulate/*/*/{TRAJECTORY}"))
    if folders and not (root / METADATA).exists():
        return tuple(_simulated(folder) for folder in folders)
    return tuple(_released(run) for run in open_release(root, None).runs)


def chosen(runs: Sequence[LoggedRun], pattern: str | None) -> tuple[LoggedRun, ...]:
    """Return the runs whose name matches a pattern, or all.

    Raises:
        InputError: No run matches.
    """
    matches = tuple(run for run in runs if pattern is None or fnmatchcase(run.name, pattern))
    if not matches:
        names = ", ".join(run.name for run in runs[:5])
        raise InputError("--runs", got=pattern, allowed=f"a pattern of names such as {names}")
    return matches


def _name(folder: Path) -> str:
    return f"{folder.parent.name}/{folder.name}"


def _simulated(folder: Path) -> LoggedRun:
    try:
        spec = RunSpec.model_validate_json(read_file(folder / SPEC, FileKind.DOCUMENT))
        recording = read_recording(folder)
    except (OSError, ValueError, KeyError, ValidationError, BadZipFile) as error:
        what = f"cannot be read: {str(error).splitlines()[0]}"
        raise InputError(what, where=str(folder), cure="run `symolo simulate` again") from None
    return LoggedRun.of_recording(_name(folder), spec, recording)


def _released(run: Run) -> LoggedRun:
    wheels, tof = (run.side(table.file.partition(".")[0]).to_numpy(float) for table in (WHEELS, TOF))
    images = run.images
    rows = np.array([image.row for image in images], dtype=np.int64)
    pictures = RunImages(rows, lambda index: images[index].pixels()) if images else None
    return LoggedRun(run.name, read_run_spec(run.folder), run.table, wheels, tof, pictures)
