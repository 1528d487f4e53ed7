"""Runs that are simulated or taken from elsewhere, and not released yet, as a dataset that can be looked at."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.run_folder.stored_runs import read_simulated, run_name
from pipeline.run_folder.stored_spec import read_simulated_spec, read_spec
from pipeline.stages.run_tables import is_external, stage_rows, stage_tables, tables
from pipeline.stages.simulate_runs import read_outcome
from sensors.build import listed_sensors
from symolo.core.errors import one_line
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.tables.time_series import Recording
from symolo.dataset.documents.camera_model import camera_files
from symolo.dataset.documents.metadata import RunRecord, describe
from symolo.dataset.layout import DATA, IMAGES, POSITIONS, SIDE, SPEC, STAGES, frame_name
from symolo.dataset.tables.camera_rows import main_camera_rows
from symolo.dataset.tables.rows import HEADER, Rows
from symolo.dataset.tables.sensor_tables import ListedSensor
from symolo.dataset.tables.side_tables import image_positions
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run


@contextmanager
def unreleased(folders: Sequence[Path]) -> Iterator[Dataset]:
    """Yield runs as a dataset in a temporary folder, with the images that are rendered so far.

    Args:
        folders: Folders of runs in `.stages/simulate`, at least one.

    Raises:
        InputError: A file of a run is missing or damaged.
    """
    with scratch_folder() as scratch:
        runs, records, specs, columns, failures = [], [], [], HEADER, {}
        for folder in folders:
            images = _rendered_images(folder)
            spec, rows, files = _taken(folder, images) if is_external(folder) else _simulated(folder, images)
            columns = rows.columns
            _write_tables(scratch / run_name(folder), files)
            sensor_tables = tuple(sensor.table for sensor in _sensors(spec))
            runs.append(Run(scratch / run_name(folder), run_name(folder), sensor_tables, images))
            outcome = read_outcome(folder)
            if outcome.problems:
                failures[run_name(folder)] = one_line("; ".join(outcome.problems))
            warnings = (*outcome.problems, *outcome.warnings)
            records.append(RunRecord.from_specification(spec, rows, outcome.lap_time_s, warnings))
            specs.append(spec)
        description = "Runs whose images are being rendered" if is_external(folders[0]) else "Simulated runs"
        sensors = _sensors(specs[0])
        metadata = describe({"description": description}, specs, records, (), sensors, columns_of_data=columns)
        yield Dataset(scratch, metadata, tuple(runs), failures)


def _simulated(folder: Path, images: Path) -> tuple[SceneSpec, Rows, dict[str, bytes]]:
    """Return a simulated run, and its files except images."""
    spec, recording = read_simulated_spec(folder / SPEC), _with_images(read_simulated(folder), images)
    rows = Rows.from_recording(recording)
    return spec, rows, {**dict(tables(spec, recording)), **dict(_main_camera_files(spec, rows, images))}


def _taken(folder: Path, images: Path) -> tuple[SceneSpec, Rows, dict[str, bytes]]:
    """Return a run whose trajectory was taken from elsewhere, and its files except images."""
    spec, rows = read_spec(folder / SPEC), stage_rows(folder)
    there = np.array([(images / frame_name(number)).is_file() for number in rows.image.tolist()], dtype=bool)
    rows = replace(rows, image=np.where(there, rows.image, 0))
    files = {**dict(stage_tables(spec, folder)), **dict(_main_camera_files(spec, rows, images))}
    return spec, rows, {**files, DATA: rows.to_csv()}


def _sensors(spec: SceneSpec) -> tuple[ListedSensor, ...]:
    """Return the sensors of a run; those of a log are described only in the finished metadata."""
    return () if spec.is_imported else listed_sensors(spec.robot)


def _rendered_images(folder: Path) -> Path:
    """Return the folder of the images of a run, which exists once one is rendered."""
    stages = next((above for above in folder.absolute().parents if above.name == STAGES), folder)
    return stages / "render" / run_name(folder) / IMAGES


def _with_images(recording: Recording, folder: Path) -> Recording:
    """Return the recording with the numbers of those images that are in a folder, and 0 for the others."""
    series = recording["image"]
    there = {int(number): (folder / frame_name(int(number))).is_file() for number in np.unique(series.values)}
    values = np.array([number if number and there[number] else 0 for number in series.values.tolist()])
    with_images = replace(series, values=values)
    return replace(recording, series=tuple(with_images if one is series else one for one in recording.series))


def _main_camera_files(spec: SceneSpec, rows: Rows, folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield the files that describe those images of the camera of data.csv that are in a folder, by their paths."""
    rows = main_camera_rows(rows, spec.rates if isinstance(spec, RunSpec) else None)
    rows = rows.where(np.array([(folder / frame_name(number)).is_file() for number in rows.image.tolist()], dtype=bool))
    yield POSITIONS, image_positions(rows)
    yield from camera_files(spec, rows)


def _write_tables(folder: Path, files: Mapping[str, bytes]) -> None:
    make_folder(folder / SIDE)
    for name, data in files.items():
        write_file(folder / name, data)
