"""Trajectories that can be rendered: those of a release, of one run, of an output of `simulate`, or of a log."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from configs.schema.scenario import RunSpec, SceneSpec
from logs.trajectories.base import ReadSettings
from pipeline.importing.imported_runs import ImportedDataset, ImportRequest, imported_dataset
from pipeline.run_folder.first_stage import has_trajectory, is_external
from pipeline.run_folder.stored_runs import read_simulated, run_name, simulated_folders
from pipeline.run_folder.stored_spec import read_spec
from pipeline.stages.cameras import logged_cameras
from pipeline.stages.run_tables import ExternalRun, tables
from pipeline.stages.simulate_runs import SPEC, RunOutcome, read_outcome
from sensors.build import listed_sensors
from symolo.core.errors import InputError
from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, Metadata, RunRecord, read_metadata, side_tables
from symolo.dataset.documents.origin import Origin, ReleaseOrigin
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.documents.splits_record import SplitName
from symolo.dataset.layout import DATA, SIDE
from symolo.dataset.manifest import MANIFEST, read_manifest, repair_cure
from symolo.dataset.tables.rows import Rows, read_rows
from symolo.dataset.tables.sensor_tables import ListedSensor
from symolo.dataset.tables.side_reading import read_side
from symolo.dataset.tables.side_tables import CAMERA, SideTable
from symolo.exporters.export import open_release

_IMAGE_WARNINGS = re.compile(
    r"(camera [^:]+: )?(\d+ of \d+ images are |the images have larger errors )|its frames were made on "
    r"|at [\d.]+ s the (camera|robot drives)"
)
"""Beginnings of warnings about the exposure and the rendering of images, and about what their camera is inside of."""
_CURE = "make the run again, or import its data.csv with --arena and --robot"


@dataclass(frozen=True)
class Sources:
    """Trajectories with everything that is known of them."""

    runs: tuple[ExternalRun, ...]
    """Runs with the specification that they had; `origin` says where they come from."""
    files: tuple[Path, ...]
    """File or folder of each trajectory, for messages."""
    name: str
    """Name of the dataset or log."""
    description: str
    licence: str
    tree: Mapping[str, Any]
    """Scenario of the source as its metadata has it; empty where there is none."""
    sensors: tuple[ListedSensor, ...]
    """Sensors with tables in `side/`."""
    imported: ImportedDataset | None = None
    """Logs that were read now, with what was guessed; None for other sources."""
    split_of: Mapping[str, SplitName] = field(default_factory=dict)
    """Split of each run by its name; empty if there are none, or if runs are divided."""
    is_whole: bool = False
    """Whether these are all runs of a dataset, rather than a single one that was named."""

    @property
    def title(self) -> str:
        """Name for an output folder: of the dataset or log, or of the only run by route and number."""
        first = self.runs[0].spec
        return self.name if self.imported or self.is_whole else first.key.replace("/", "-")

    @property
    def recorded_cameras(self) -> tuple[str, ...]:
        """Names of the cameras whose images a log has; no image of them is rendered."""
        logged = [one.name for log in (self.imported.logs if self.imported else ()) for one in log.trajectory.cameras]
        return tuple(dict.fromkeys([*logged, *(name for run in self.runs for name in logged_cameras(run.spec))]))


def read_sources(paths: Sequence[Path], runs: str | None, request: ImportRequest) -> Sources:
    """Return the trajectories at these paths.

    Args:
        paths: One release, run folder or output of `simulate`; or logs.
        runs: Pattern of names of the runs of a release; all by default.
        request: How logs are read.

    Raises:
        InputError: A path holds no trajectory, it is damaged, or no run matches.
    """
    if len(paths) == 1 and (sources := _symolo_sources(paths[0])) is not None:
        if request.format or request.row_hz or request.settings != ReadSettings():
            cure = "leave out the options that say how to read a log"
            raise InputError("is a dataset of symolo, and no log", where=str(paths[0]), cure=cure)
        return _matching(sources, runs)
    if runs is not None:
        raise InputError("--runs", got=runs, cure="leave it out: only a release has runs to choose from")
    for path in paths:
        if not path.exists():
            cure = "name a release, a run folder or a log"
            raise InputError("no such file or folder", where=str(path), cure=cure)
        if len(paths) > 1 and _symolo_sources(path) is not None:
            raise InputError("is a dataset of symolo", where=str(path), cure="render one dataset at a time")
        if path.is_dir() and not any(path.iterdir()):
            raise InputError("is an empty folder", where=str(path), cure="name a release, a run folder or a log")
    dataset = imported_dataset(replace(request, paths=tuple(paths), with_images=True))
    tree = {name: dataset.tree[name] for name in ("arena", "robot")}
    return Sources(
        dataset.runs,
        tuple(log.path for log in dataset.logs),
        str(dataset.tree["name"]),
        str(dataset.tree["description"]),
        request.licence,
        tree,
        dataset.sensors,
        dataset,
    )


def _symolo_sources(path: Path) -> Sources | None:
    """Return the runs of a folder that symolo made; None for any other path."""
    folder = path.parent if path.name == DATA and not path.is_dir() else path
    if not folder.is_dir():
        return None
    if (folder / METADATA).is_file() or (folder / DECLARATION).is_file():
        return _release_sources(folder)
    if has_trajectory(folder):
        return _stage_sources([folder])
    if (folder / DATA).is_file() and (folder / SIDE / SPEC).is_file():
        return _run_sources(folder)
    simulated = simulated_folders(folder)
    return _stage_sources(simulated) if simulated else None


def _release_sources(root: Path) -> Sources:
    data = open_release(root, None)
    assert data.metadata is not None  # noqa: S101 - a release has it
    digest = sha256_of(data.root / MANIFEST)
    records = {record.run: record for record in data.metadata.runs}
    runs = [_released(run.folder, records[run.name], data.metadata, digest) for run in data.runs]
    folders = tuple(run.folder / DATA for run in data.runs)
    return replace(_with_metadata(tuple(runs), folders, data.metadata), is_whole=True)


def _run_sources(folder: Path) -> Sources:
    """Return one run, whose release is recognised from the folders above it."""
    metadata = read_metadata(folder.absolute().parents[1])
    record = next((each for each in metadata.runs if each.run == run_name(folder)), None) if metadata else None
    if metadata is not None and record is not None:
        manifest = folder.absolute().parents[1] / MANIFEST
        digest = sha256_of(manifest) if manifest.is_file() else ""
        run = _released(folder, record, metadata, digest)
        if digest:
            _check_as_released(folder, manifest, (DATA, f"{SIDE}/{SPEC}", *run.side))
        return _with_metadata((run,), (folder / DATA,), metadata)
    spec = read_spec(folder / SIDE / SPEC, _CURE)
    if spec.is_imported:
        what = "is a run of an import without its metadata.json, which describes its tables"
        raise InputError(what, where=str(folder), cure="name the dataset, or a run within it")
    sensors = listed_sensors(spec.robot)
    run = _taken(folder, spec, sensors, RunOutcome.of_rows(read_rows(folder / DATA)), "")
    return Sources((run,), (folder / DATA,), spec.scenario, "", "", {}, sensors)


def _check_as_released(folder: Path, manifest: Path, names: Sequence[str]) -> None:
    """Refuse the folder of a run in which one of these files is not as it was released."""
    try:
        listed = read_manifest(read_file(manifest, FileKind.CHECKSUMS))
    except ValueError as error:
        cure = repair_cure(manifest, "")
        raise InputError(f"is damaged: {error}", where=str(manifest), cure=cure) from None
    for name in names:
        if listed.get(f"{run_name(folder)}/{name}") != sha256_of(folder / name):
            path = folder / name
            raise InputError(f"its SHA-256 is not that of {MANIFEST}", where=str(path), cure=repair_cure(path, ""))


def _with_metadata(runs: tuple[ExternalRun, ...], files: tuple[Path, ...], metadata: Metadata) -> Sources:
    return Sources(
        runs,
        files,
        metadata.name,
        metadata.description,
        metadata.licence,
        metadata.scenario,
        metadata.listed_sensors,
        split_of=metadata.splits.split_by_run if metadata.splits else {},
    )


def _released(folder: Path, record: RunRecord, metadata: Metadata, digest: str) -> ExternalRun:
    spec = read_spec(folder / SIDE / SPEC, _CURE)
    # Warnings about images are those of the images that are replaced.
    suspicions = [text for text in record.warnings if not _IMAGE_WARNINGS.match(text)]
    outcome = RunOutcome.of_rows(
        read_rows(folder / DATA), record.lap_time_s, record.board, record.controller, suspicions
    )
    return _taken(folder, spec, metadata.listed_sensors, outcome, digest)


def _taken(
    folder: Path, spec: SceneSpec, sensors: Sequence[ListedSensor], outcome: RunOutcome, digest: str
) -> ExternalRun:
    """Return a run from its folder, with the tables that do not follow from its specification."""
    known = side_tables(RunDocument.model_validate(spec))
    tables = (*known, *(sensor.table for sensor in sensors))
    copied = [table for table in tables if table is not CAMERA and table.name != "obstacles"]
    rows = read_rows(folder / DATA)
    side = {f"{SIDE}/{table.file}": _checked_side(folder / SIDE / table.file, table, rows) for table in copied}
    return ExternalRun(_with_origin(spec, digest), rows, side, outcome)


def _checked_side(path: Path, table: SideTable, rows: Rows) -> bytes:
    """Return the bytes of a side table that fits data.csv."""
    read_side(path, table, rows)
    return read_file(path, FileKind.TABLE)


def _with_origin(spec: SceneSpec, digest: str) -> SceneSpec:
    """Return the specification with the release in which the trajectory was published first."""
    origin = spec.origin or Origin()
    if origin.release is None:
        release = ReleaseOrigin(name=spec.scenario, manifest_sha256=digest, run=spec.key)
        origin = origin.model_copy(update={"release": release})
    return spec.model_copy(update={"origin": origin})


def _stage_sources(folders: Sequence[Path]) -> Sources:
    """Return runs from their first stage, whether or not they were released."""
    runs = []
    for folder in folders:
        spec, outcome = read_spec(folder / SPEC, _CURE), read_outcome(folder)
        if outcome.problems and len(folders) > 1:
            continue
        if not isinstance(spec, RunSpec) or is_external(folder):
            raise InputError("was not simulated", where=str(folder), cure="name the dataset, or a run within it")
        recording = read_simulated(folder)
        side = {name: data for name, data in tables(spec, recording) if _is_kept(name)}
        runs.append(ExternalRun(_with_origin(spec, ""), Rows.from_recording(recording), side, outcome))
    if not runs:
        raise InputError("has no run without a problem", where=str(folders[0].parent), cure="see `symolo status`")
    first, is_whole = runs[0].spec, len(folders) > 1
    sensors = listed_sensors(first.robot)
    return Sources(tuple(runs), tuple(folders), first.scenario, "", "", {}, sensors, is_whole=is_whole)


def _is_kept(name: str) -> bool:
    """Return whether a file of a run is a table that does not follow from its specification and its rows."""
    folder, _, file = name.rpartition("/")
    return folder == SIDE and file.endswith(".csv") and file not in {CAMERA.file, "obstacles.csv"}


def _matching(sources: Sources, pattern: str | None) -> Sources:
    if pattern is None:
        return sources
    chosen = [i for i, run in enumerate(sources.runs) if fnmatchcase(run.spec.key, pattern)]
    if not chosen:
        names = ", ".join(run.spec.key for run in sources.runs[:5])
        raise InputError("--runs", got=pattern, allowed=f"a pattern of names such as {names}")
    runs, files = (tuple(items[i] for i in chosen) for items in (sources.runs, sources.files))
    return replace(sources, runs=runs, files=files)
