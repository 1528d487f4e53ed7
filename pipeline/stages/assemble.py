"""Stage 3: assembles good runs into the released dataset, with description, metadata and checksums."""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from configs.schema.scenario import SceneSpec
from configs.schema.splits import Splits
from pipeline.assembly.description import markdown
from pipeline.run_folder.workspace import Workspace, input_key, mark_done
from pipeline.stages.annotate import copy_released, released_annotations
from pipeline.stages.assembled_run import AssembledRun, assembled_run, cameras_with_images
from pipeline.stages.cameras import RunCamera
from pipeline.stages.run_tables import stage_tables
from sensors.build import listed_sensors
from symolo.arena.fingerprint import arena_fingerprint
from symolo.arena.geometry import Arena
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files.atomic_files import make_folder, remove_file, remove_folder, replace_folder, write_file
from symolo.core.files.file_hashes import hashes_of, holds, read_known
from symolo.core.files.plain_files import FileKind, is_plain_file, read_file
from symolo.core.progress import Report, plural
from symolo.core.versions import versions
from symolo.dataset.bag import BAG_INFO, bag_info
from symolo.dataset.documents.metadata import METADATA, FailedRun, RunRecord, describe, read_metadata
from symolo.dataset.documents.splits_record import SplitsRecord
from symolo.dataset.layout import DESCRIPTION, DONE, IMAGES, SIDE, STAGES
from symolo.dataset.manifest import MANIFEST, SEALS, TAG_MANIFEST, manifest, tag_manifest
from symolo.dataset.splits import SplitMember, assign
from symolo.dataset.tables.sensor_tables import ListedSensor

METADATA_COPY = Path(STAGES) / "assemble" / METADATA
"""Copy of the metadata in the hidden stages; from the metadata, everything else can be made again."""
FORM = 2
"""Version of the list of files of a run; releases with another number are assembled again. 1 had no side/scene.json."""
CHECKSUMS = (TAG_MANIFEST, MANIFEST)
"""Lists of checksums in the order in which they are removed, before the files that they name."""


@dataclass(frozen=True)
class _Checked:
    """A released file as the lists of checksums have it."""

    sha256: str
    size_bytes: int

    @classmethod
    def from_bytes(cls, data: bytes) -> "_Checked":
        return cls(hashlib.sha256(data).hexdigest(), len(data))


def assemble(
    workspace: Workspace,
    tree: dict[str, Any],
    specs: Sequence[SceneSpec],
    failures: Sequence[FailedRun],
    report: Report,
    *,
    sensors: Sequence[ListedSensor] | None = None,
    protected: frozenset[str] = frozenset(),
) -> None:
    """Release every run without a problem, and remove released runs that have one now.

    Args:
        workspace: The output folder, with the stages before this one done.
        tree: The scenario as loaded, with its distributions.
        specs: All runs of the scenario.
        failures: Failures of the stages before.
        report: Progress report.
        sensors: Sensors of the runs; by default the loaded classes of those of `robot.sensors`.
        protected: Runs of a finished release that are not removed even if they have failed.

    Raises:
        InputError: A protected run has failed, or the files of a signed release would change. Nothing is removed.
    """
    failed = {failure.run for failure in failures}
    _check_protected(workspace.out, [failure for failure in failures if failure.run in protected])
    good = [spec for spec in specs if spec.key not in failed]
    top = partial(_top_files, tree=tree, specs=specs, failures=failures, sensors=sensors)
    tags_before = _tags_in(workspace.out)
    if protected and _is_sealed(workspace.out) and _planned_tags(workspace, good, top) != tags_before:
        raise InputError(
            f"contains the finished dataset {specs[0].scenario}: the signature would be lost, because other files were "
            "made now; no released file was changed",
            where=f"--out {workspace.out}",
            cure="name another folder with --out, or give --replace",
        )
    _remove_stale_runs(workspace, {spec.key for spec in good}, failed, report)
    runs, files = _released(workspace, good, report)
    splits = _splits(tree, specs, [run.record for run in runs])
    for name in splits.empty if splits and good else ():
        report.say(f"assemble: warning: the split {name} is empty, because its runs failed")
    if not good:
        _remove_seals(workspace.out, report)
        _remove_files(workspace.out, (*CHECKSUMS, BAG_INFO, METADATA, DESCRIPTION))
        return
    _write_top(workspace.out, top(runs, files), tags_before, report)


def _released(
    workspace: Workspace, specs: Sequence[SceneSpec], report: Report
) -> tuple[list[AssembledRun], dict[str, _Checked]]:
    """Write the files of all runs into the dataset; return the runs, and the files by their path in the dataset."""
    runs: list[AssembledRun] = []
    files: dict[str, _Checked] = {}
    with report.stage("assemble", len(specs), "runs") as stage:
        for spec in specs:
            for name, digest in release_run(workspace, spec).items():
                path = f"{spec.key}/{name}"
                files[path] = _Checked(digest, (workspace.out / path).stat().st_size)
            run = assembled_run(workspace, spec)
            if run.record.cpu_classes:
                stage.say(f"{spec.key}: {several_classes_text(run.record.cpu_classes)}")
            runs.append(run)
            stage.update(spec.key, 1)
    return runs, files


def _check_protected(out: Path, failures: Sequence[FailedRun]) -> None:
    """Refuse to remove runs of a finished release that have failed now."""
    if failures:
        first, runs = failures[0], {failure.run for failure in failures}
        raise InputError(
            f"{plural(len(runs), 'released run')} failed now, and no run was removed from the finished dataset; "
            f"{first.run}: {first.stage}: {first.problem}",
            where=f"--out {out}",
            cure=f"see `symolo status {out}`, or give --replace",
        )


def _splits(tree: dict[str, Any], specs: Sequence[SceneSpec], records: Sequence[RunRecord]) -> SplitsRecord | None:
    """Return the division of the released runs, or None if the scenario has none.

    The failed runs take part in it, so that the splits of the others do not depend on which runs failed.
    """
    if tree.get("splits") is None:
        return None
    images = {record.run: range(1, record.images + 1) for record in records}
    rule = Splits.model_validate(tree["splits"]).rule(specs[0].seed)
    by_arena = rule.by == "arena"
    members = [
        SplitMember(
            spec.key,
            spec.look.name,
            spec.robot.name,
            spec.seed,
            spec.origin,
            images.get(spec.key, ()),
            arena_fingerprint(Arena.from_config(spec.arena)) if by_arena else "",
        )
        for spec in specs
    ]
    return assign(rule, members, METADATA).only(images)


def several_classes_text(cpus: Sequence[str]) -> str:
    """Return the warning about a run whose frames were made on several classes of processor."""
    return f"its frames were made on {' and '.join(cpus)}: low bits may not be those of a machine of one class"


def _top_files(
    runs: Sequence[AssembledRun],
    files: Mapping[str, _Checked],
    *,
    tree: dict[str, Any],
    specs: Sequence[SceneSpec],
    failures: Sequence[FailedRun],
    sensors: Sequence[ListedSensor] | None,
) -> dict[str, bytes]:
    """Return the files at the top of a release by name; `files` are those of its runs."""
    records = [run.record for run in runs]
    sensors = listed_sensors(specs[0].robot) if sensors is None else sensors
    splits = _splits(tree, specs, records)
    metadata = describe(tree, specs, records, failures, sensors, columns_of_data=runs[-1].columns, splits=splits)
    top = {METADATA: metadata.to_json(), DESCRIPTION: markdown(metadata, runs[0].spec)}
    files = {**files, **{name: _Checked.from_bytes(data) for name, data in top.items()}}
    sizes = {name: file.size_bytes for name, file in files.items()}
    info = bag_info(metadata.name, metadata.description, sizes, frozenset[str]().union(*(run.cpus for run in runs)))
    hashes = {name: file.sha256 for name, file in files.items()} | {BAG_INFO: hashlib.sha256(info).hexdigest()}
    return {**top, BAG_INFO: info, MANIFEST: manifest(hashes), TAG_MANIFEST: tag_manifest(hashes)}


def _write_top(out: Path, top: Mapping[str, bytes], tags_before: bytes, report: Report) -> None:
    """Write the files at the top of a release; the checksum of the checksums comes last."""
    _write_if_new(out / METADATA_COPY, top[METADATA])
    for name in (METADATA, DESCRIPTION):
        _write_if_new(out / name, top[name])
    if top[TAG_MANIFEST] != tags_before:  # a signature of the lists before would be taken for a forgery
        _remove_seals(out, report)
    for name in (BAG_INFO, MANIFEST, TAG_MANIFEST):
        _write_if_new(out / name, top[name])


def _planned_tags(
    workspace: Workspace,
    good: Sequence[SceneSpec],
    top: Callable[[Sequence[AssembledRun], Mapping[str, _Checked]], Mapping[str, bytes]],
) -> bytes:
    """Return the checksum of the checksums of a release of these runs, of which nothing is written."""
    files = {f"{spec.key}/{name}": file for spec in good for name, file in _planned_files(workspace, spec)}
    return top([assembled_run(workspace, spec) for spec in good], files)[TAG_MANIFEST]


def _planned_files(workspace: Workspace, spec: SceneSpec) -> Iterator[tuple[str, _Checked]]:
    """Yield the files of a run by their paths in its folder, from its stages."""
    for name, data in stage_tables(spec, workspace.simulate(spec.key).path):
        yield name, _Checked.from_bytes(data)
    for camera in cameras_with_images(workspace, spec):
        folders = [(workspace.render(spec.key, camera.name), released_images)]
        if camera.spec.render.annotations:
            folders.append((workspace.annotate(spec.key, camera.name), released_annotations))
        for folder, released in folders:
            for name, digest in released(folder.files()).items():
                yield camera.inner(name), _Checked(digest, (folder.path / name).stat().st_size)


def release_run(workspace: Workspace, spec: SceneSpec) -> dict[str, str]:
    """Put the folder of a run in place unless it is there unchanged, and return the SHA-256 of its files by path.

    Raises:
        EnvironmentLacking: Files of the stages, or of the new folder, are not what was written.
    """
    stages = {"simulate": workspace.simulate(spec.key)}
    cameras = cameras_with_images(workspace, spec)
    for camera in cameras:
        stages[camera.inner("render")] = workspace.render(spec.key, camera.name)
        if camera.spec.render.annotations:
            stages[camera.inner("annotate")] = workspace.annotate(spec.key, camera.name)
    files = {name: stage.files() for name, stage in stages.items()}
    key = input_key("assemble", stages=files, form=FORM, versions=versions("symolo", "numpy"))
    marker, released = workspace.assemble(spec.key), workspace.out / spec.key
    done = marker.done()
    if done is not None and done.key == key and holds(released, done.files):
        return done.files
    _remove_files(workspace.out, CHECKSUMS)
    partial = marker.start()
    written = _fill(workspace, spec, cameras, files, partial)
    hashes = hashes_of(partial)
    if hashes != written:
        raise EnvironmentLacking(f"{partial} is not on the disk as it was written; run the same command again")
    replace_folder(partial, released)
    make_folder(marker.path)
    mark_done(marker.path, key, hashes)
    return hashes


def _fill(
    workspace: Workspace,
    spec: SceneSpec,
    cameras: Sequence[RunCamera],
    stages: Mapping[str, Mapping[str, str]],
    folder: Path,
) -> dict[str, str]:
    """Write the files of a run and return their SHA-256 by path; without images, there are no cameras."""
    make_folder(folder / SIDE)
    for camera in cameras:
        make_folder(folder / camera.inner(SIDE))
        make_folder(folder / camera.inner(IMAGES))
    written: dict[str, str] = {}
    for name, data in stage_tables(spec, workspace.simulate(spec.key).path):
        make_folder((folder / name).parent)
        write_file(folder / name, data)
        written[name] = hashlib.sha256(data).hexdigest()
    for camera in cameras:
        place = folder / camera.inner("")
        copied = copy_images(workspace.render(spec.key, camera.name).path, stages[camera.inner("render")], place)
        if camera.spec.render.annotations:
            copied |= copy_released(workspace.annotate(spec.key, camera.name), place)
        written |= {camera.inner(name): digest for name, digest in copied.items()}
    return written


def copy_images(stage: Path, files: Mapping[str, str], run: Path) -> dict[str, str]:
    """Copy the images of a stage's folder into that of a run, and return their SHA-256 by path.

    Args:
        stage: Folder of the stage.
        files: SHA-256 of all its files by path.
        run: Folder of the run.
    """
    images = released_images(files)
    for name, digest in images.items():
        write_file(run / name, read_known(stage / name, digest))
    return images


def released_images(files: Mapping[str, str]) -> dict[str, str]:
    """Return the images among the files of a stage, with their SHA-256 by path."""
    return {name: digest for name, digest in sorted(files.items()) if name.startswith(f"{IMAGES}/")}


def _remove_stale_runs(workspace: Workspace, good: set[str], failed: set[str], report: Report) -> None:
    """Remove released runs that are no longer in the scenario, or that have failed, and report each."""
    for run in sorted(released_runs(workspace) - good):
        _remove_files(workspace.out, CHECKSUMS)
        remove_folder(workspace.out / run)
        route = (workspace.out / run).parent
        if route.is_dir() and not any(route.iterdir()):
            remove_folder(route)
        remove_folder(workspace.assemble(run).path)  # last: while it is there, a rerun takes up what was interrupted
        report.say(f"removed: {run}, which " + ("has failed" if run in failed else "does not belong to the scenario"))


def _tags_in(out: Path) -> bytes:
    """Return the checksum of the checksums in a folder; empty if there is none."""
    return read_file(out / TAG_MANIFEST, FileKind.ANY) if is_plain_file(out / TAG_MANIFEST) else b""


def _is_sealed(out: Path) -> bool:
    return any((out / name).exists() for name in SEALS)


def _remove_seals(out: Path, report: Report) -> None:
    """Remove what `symolo sign` added, and report it."""
    if _is_sealed(out):
        report.say("removed: the signature, because the signed files have changed")
    _remove_files(out, SEALS)


def released_runs(workspace: Workspace) -> set[str]:
    """Return the runs released before, by the stages or, if these were deleted, by metadata.json."""
    root = workspace.out / STAGES / "assemble"
    marked = {run for run in (_runs_in(root) if root.is_dir() else ()) if (root / run / DONE).is_file()}
    metadata = read_metadata(workspace.out)
    if metadata is None:
        return marked
    # Only runs that have a folder here count, because a name in the file may lead anywhere.
    return marked | _runs_in(workspace.out) & {record.run for record in metadata.runs}


def _runs_in(folder: Path) -> set[str]:
    """Return the names of the runs in a folder, `<route>/test_<n>`.

    `glob` would pass over folders that it has no right to read; `iterdir` raises an error.
    """
    routes = [path for path in folder.iterdir() if path.is_dir() and not path.name.startswith(".")]
    runs = [run for route in routes for run in route.iterdir() if run.is_dir() and run.name.startswith("test_")]
    return {f"{run.parent.name}/{run.name}" for run in runs}


def _remove_files(folder: Path, names: Sequence[str]) -> None:
    for name in names:
        remove_file(folder / name)


def _write_if_new(path: Path, data: bytes) -> None:
    if not _holds(path, data):
        write_file(path, data)


def _holds(path: Path, data: bytes) -> bool:
    return is_plain_file(path) and read_file(path, FileKind.ANY) == data
