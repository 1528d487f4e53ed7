"""The tables of a run from its first stage: of a simulation, or taken from a log or from another release."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.assembly.scene_file import scene_file
from pipeline.run_folder.first_stage import TAKEN, is_external, read_recording
from pipeline.run_folder.workspace import StageFolder, input_key
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import image_seed
from pipeline.stages.simulate_runs import OUTCOME, SPEC, RunOutcome, refresh_spec, spec_text
from sensors.build import listed_sensors
from symolo.arena.geometry import Arena
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.tables.time_series import Recording
from symolo.dataset.documents.camera_model import camera_files
from symolo.dataset.layout import CAMERAS, DATA, POSITIONS, SIDE
from symolo.dataset.tables.obstacles import obstacle_table, obstacles_csv, obstacles_csv_at
from symolo.dataset.tables.rows import Rows, read_rows
from symolo.dataset.tables.sensor_tables import ListedSensor, sensor_csv
from symolo.dataset.tables.side_tables import BOARD, TOF, WHEELS, board_csv, image_positions, tof_csv, wheels_csv


@dataclass(frozen=True)
class ExternalRun:
    """A run whose trajectory was not simulated here, but imported from a log or taken from another release."""

    spec: SceneSpec
    rows: Rows
    side: Mapping[str, bytes]
    """Content of what does not follow from the specification, by its path in the run: tables in `side/`, and the
    folders of the cameras of a log."""
    outcome: RunOutcome


def write_external_run(run: ExternalRun, folder: StageFolder) -> None:
    """Write the first stage of a run, unless it is there from the same inputs."""
    files = {DATA: run.rows.to_csv(), **run.side}
    digests = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()}
    outcome = canonical_json(run.outcome.model_dump(mode="json"))
    key = input_key("take", tables=digests, outcome=outcome.decode())
    if not folder.is_done(key):
        partial = folder.start()
        for name, data in files.items():
            make_folder((partial / TAKEN / name).parent)
            write_file(partial / TAKEN / name, data)
        write_file(partial / OUTCOME, outcome)
        write_file(partial / SPEC, spec_text(run.spec))
        folder.publish(partial, key)
    refresh_spec(folder, key, run.spec)


def stage_rows(folder: Path) -> Rows:
    """Return data.csv of a run from the folder of its first stage.

    Raises:
        InputError: A table that was taken is damaged.
        OSError: A file is missing.
        ValueError: The trajectory is damaged.
    """
    return read_rows(folder / TAKEN / DATA) if is_external(folder) else Rows.from_recording(read_recording(folder))


def stage_has_images(spec: SceneSpec, folder: Path) -> bool:
    """Return whether images belong to a run; it may be simulated or imported without any."""
    return bool(cameras_of(spec)) and (not spec.is_imported or bool(stage_rows(folder).image.any()))


def stage_tables(
    spec: SceneSpec, folder: Path, sensors: Sequence[ListedSensor] | None = None
) -> Iterator[tuple[str, bytes]]:
    """Yield the released files of a run except images and annotations, with their paths in its folder.

    Args:
        spec: Specification of the run.
        folder: Folder of its first stage.
        sensors: Sensors whose tables are written; None for all of the robot, whose classes must be loaded.
    """
    if is_external(folder):
        yield from _taken_tables(spec, folder / TAKEN)
    else:
        assert isinstance(spec, RunSpec)  # noqa: S101 - what was simulated has the rates of a simulation
        yield from tables(spec, read_recording(folder), sensors)


def tables(
    spec: RunSpec, recording: Recording, sensors: Sequence[ListedSensor] | None = None
) -> Iterator[tuple[str, bytes]]:
    """Yield the released files of a simulated run except images and annotations, with their paths in its folder.

    `sensors` are as for `stage_tables`.
    """
    rows = Rows.from_recording(recording)
    yield DATA, rows.to_csv()
    yield f"{SIDE}/{WHEELS.file}", wheels_csv(recording)
    yield f"{SIDE}/{TOF.file}", tof_csv(recording)
    if spec.board:
        yield f"{SIDE}/{BOARD.file}", board_csv(recording)
    for sensor in listed_sensors(spec.robot) if sensors is None else sensors:
        yield f"{SIDE}/{sensor.table.file}", sensor_csv(sensor.table, recording)
    arena = Arena.from_config(spec.arena)
    if (obstacles := obstacle_table(arena)) is not None:
        yield f"{SIDE}/{obstacles.file}", obstacles_csv(obstacles, arena, recording)
    if rows.image.any():
        yield from _camera_files(spec, rows)
    yield f"{SIDE}/{SPEC}", spec_text(spec)


def _taken_tables(spec: SceneSpec, folder: Path) -> Iterator[tuple[str, bytes]]:
    rows = read_rows(folder / DATA)
    yield DATA, rows.to_csv()
    side = sorted((folder / SIDE).iterdir()) if (folder / SIDE).is_dir() else []
    for path in side:
        yield f"{SIDE}/{path.name}", read_file(path, FileKind.TABLE)
    for path in sorted(path for path in (folder / CAMERAS).rglob("*") if path.is_file()):
        yield path.relative_to(folder).as_posix(), read_file(path, FileKind.ANY)
    arena = Arena.from_config(spec.arena)
    if (obstacles := obstacle_table(arena)) is not None:
        row_hz = spec.rates.control_hz if isinstance(spec, RunSpec) else None
        yield f"{SIDE}/{obstacles.file}", obstacles_csv_at(obstacles, arena, rows, row_hz)
    if rows.image.any():
        yield from _camera_files(spec, rows)
    yield f"{SIDE}/{SPEC}", spec_text(spec)


def _camera_files(spec: SceneSpec, rows: Rows) -> Iterator[tuple[str, bytes]]:
    """Yield the files that describe the images of all cameras of a run."""
    for camera in cameras_of(spec):
        at_images = camera.rows(rows)
        yield camera.inner(POSITIONS), image_positions(at_images)
        for name, data in camera_files(camera.spec, at_images):
            yield camera.inner(name), data
    yield scene_file(spec.arena, spec.look, image_seed(spec.seed, *spec.drawn_as))
