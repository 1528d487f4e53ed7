"""What a command would take away from a finished release, which it does only if the user says so."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.run_folder.status import image_changes, in_order
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import released_runs
from pipeline.stages.cameras import cameras_of, logged_cameras
from pipeline.stages.simulate_runs import simulation_key
from sensors.registry import SENSORS
from symolo.core.errors import InputError
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import is_plain_file
from symolo.core.progress import Report, plural
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.documents.metadata import Metadata, RunRecord, made_with, read_metadata
from symolo.dataset.documents.run_records import CameraRecord
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, SEALS, TAG_MANIFEST
from symolo.dataset.tables.sensor_tables import LOGGED

MAX_NAMES = 3
"""Largest number of runs that a line names."""


@dataclass(frozen=True)
class Losses:
    """Parts of a finished release that the next one takes away."""

    name: str
    """Name of the finished dataset; empty if it is not known."""
    new_name: str
    """Name of the dataset that the command makes."""
    runs: tuple[str, ...]
    """Released runs that would be removed or measured again, or all of them if the dataset has another name."""
    images: int
    """Number of their images, of all cameras, and of those of cameras that the other runs no longer have."""
    annotations: tuple[str, ...]
    """Annotations that images of the other runs no longer have."""
    own_sensors: tuple[str, ...]
    """Sensors that the other runs no longer have, and whose kind is in a file of the user that is not loaded."""
    signature: bool

    @property
    def text(self) -> str:
        """All of it in words; empty if nothing is lost."""
        parts = [
            named_runs(self.runs) if self.runs else "",
            plural(self.images, "image") if self.images else "",
            f"annotations ({', '.join(self.annotations)})" if self.annotations else "",
            f"the readings of {', '.join(self.own_sensors)} (neither sensor_files nor --sensor-file names its file)"
            if self.own_sensors
            else "",
            "the signature" if self.signature else "",
        ]
        *first, last = [part for part in parts if part] or [""]
        return f"{', '.join(first)} and {last}" if first else last

    @property
    def dataset(self) -> str:
        """The finished dataset in words."""
        return f"the finished dataset {self.name}" if self.name else "a finished dataset"


def named_runs(runs: Sequence[str]) -> str:
    """Return a number of runs with the names of the first ones."""
    more = f" and {len(runs) - MAX_NAMES} more" if len(runs) > MAX_NAMES else ""
    return f"{plural(len(runs), 'run')} ({', '.join(runs[:MAX_NAMES])}{more})"


def losses_of(workspace: Workspace, tree: dict[str, Any], specs: Sequence[SceneSpec]) -> Losses:
    """Return what the folder would lose if the runs `specs` of the scenario `tree` were released into it."""
    out, new_name = workspace.out, specs[0].scenario
    if not _is_finished(workspace):
        return Losses("", new_name, (), 0, (), (), signature=False)
    metadata = read_metadata(out) or read_metadata(out / STAGES / "assemble")
    released = released_runs(workspace)
    is_same = metadata is not None and metadata.name == new_name
    unchanged = {spec.key: spec for spec in specs if spec.key in released} if is_same else {}
    for record in metadata.runs if metadata else ():
        if record.run in unchanged and _is_measured_again(workspace, record, unchanged[record.run]):
            del unchanged[record.run]
    runs = released - unchanged.keys()
    images, annotations = _images_and_annotations(metadata, runs, unchanged)
    is_signed = any((out / name).exists() for name in SEALS)
    return Losses(
        metadata.name if metadata else "",
        new_name,
        tuple(sorted(runs, key=in_order)),
        images,
        annotations,
        _own_sensors(metadata, unchanged),
        signature=is_signed and (bool(runs) or _changes(workspace, metadata, tree, specs)),
    )


def check_losses(
    workspace: Workspace,
    tree: dict[str, Any],
    specs: Sequence[SceneSpec],
    report: Report,
    *,
    replace: bool,
    dry_run: bool = False,
) -> None:
    """Refuse to take anything away from a finished release before the work begins.

    Args:
        workspace: The output folder.
        tree: The scenario as loaded.
        specs: Its runs.
        report: Receiver of a line about what would be lost, with `replace` and `dry_run`.
        replace: Whether the release may lose something.
        dry_run: Whether nothing will be done.

    Raises:
        InputError: Something would be lost, without `replace`.
    """
    losses = losses_of(workspace, tree, specs)
    if not replace:
        _refuse(workspace, losses)
    elif losses.text and dry_run:
        report.say(f"--replace: {losses.dataset} would lose {losses.text}")


def protected_runs(
    workspace: Workspace, tree: dict[str, Any], specs: Sequence[SceneSpec], report: Report, *, replace: bool
) -> frozenset[str]:
    """Check again in the locked folder, report what will be lost, and return the runs that stay even if they fail.

    Another command may have finished its dataset between the first check and the lock.

    Raises:
        InputError: Something would be lost, without `replace`.
    """
    losses = losses_of(workspace, tree, specs)
    if not replace:
        _refuse(workspace, losses)
        return frozenset(released_runs(workspace)) if _is_finished(workspace) else frozenset()
    if losses.text:
        report.say(f"--replace: {losses.dataset} loses {losses.text}")
    return frozenset()


def _refuse(workspace: Workspace, losses: Losses) -> None:
    if losses.text:
        other = f", and not {losses.new_name}" if losses.name not in {losses.new_name, ""} else ""
        raise InputError(
            f"contains {losses.dataset}{other}: {losses.text} would be lost",
            where=f"--out {workspace.out}",
            cure="name another folder with --out, or give --replace",
        )


def _is_finished(workspace: Workspace) -> bool:
    """Return whether there is a list of checksums: an interrupted command leaves none, and damage may leave one."""
    return any(is_plain_file(workspace.out / name) for name in (MANIFEST, TAG_MANIFEST))


def _changes(workspace: Workspace, metadata: Metadata | None, tree: dict[str, Any], specs: Sequence[SceneSpec]) -> bool:
    """Return whether released files would get another content, as far as their inputs tell."""
    if metadata is not None:
        versions = made_with()
        if any(versions.get(program) != version for program, version in metadata.made_with.items()):
            return True
        if canonical_json(metadata.scenario) != canonical_json(tree):
            return True
    return any(image_changes(workspace, spec.key, spec) or _has_another_key(workspace, spec) for spec in specs)


def _has_another_key(workspace: Workspace, spec: SceneSpec) -> bool:
    """Return whether a run was simulated from other inputs, such as another content of the controller's file."""
    if not isinstance(spec, RunSpec) or spec.origin is not None:
        return False
    done = workspace.simulate(spec.key).done()
    return done is not None and done.key != simulation_key(spec)


def _is_measured_again(workspace: Workspace, record: RunRecord, spec: SceneSpec) -> bool:
    """Return whether a run that no scenario repeats, by a log or by a real board, would get other data."""
    if record.origin is not None:
        before, now = record.origin.log, spec.origin.log if spec.origin else None
        return before is not None and (now is None or now.sha256 != before.sha256)
    if record.board is None or record.board.kind != "serial":
        return False
    return not isinstance(spec, RunSpec) or not workspace.simulate(spec.key).is_done(simulation_key(spec))


def _images_and_annotations(
    metadata: Metadata | None, removed: Iterable[str], unchanged: Mapping[str, SceneSpec]
) -> tuple[int, tuple[str, ...]]:
    """Return the number of images that are lost, and the annotations that other images no longer have."""
    images, annotations = 0, set[str]()
    for record in metadata.runs if metadata else ():
        if record.run not in removed and record.run not in unchanged:
            continue  # its folder is gone
        cameras: dict[str, RunRecord | CameraRecord] = {"": record, **record.cameras}
        there = _annotations_by_camera(unchanged[record.run]) if record.run in unchanged else {}
        for name, camera in cameras.items():
            if name in there:
                annotations |= {*camera.annotations} - {*there[name]}
            else:
                images += camera.images
    return images, tuple(sorted(annotations))


def _own_sensors(metadata: Metadata | None, unchanged: Mapping[str, SceneSpec]) -> tuple[str, ...]:
    """Return the sensors that runs lose and that the loaded kinds cannot make again: a file was probably forgotten."""
    if metadata is None or not unchanged:
        return ()
    kinds = {*SENSORS.by_name(), LOGGED}
    remaining = {(name, settings.kind or name) for spec in unchanged.values() for name, settings in spec.robot.sensors}
    return tuple(
        name
        for name, sensor in metadata.sensors.items()
        if sensor.kind not in kinds and (name, sensor.kind) not in remaining
    )


def _annotations_by_camera(spec: SceneSpec) -> dict[str, tuple[AnnotationName, ...]]:
    """Return the annotations of the images of each camera of a run by its name."""
    annotations: dict[str, tuple[AnnotationName, ...]] = dict.fromkeys(logged_cameras(spec), ())
    return annotations | {camera.name: camera.spec.render.annotations for camera in cameras_of(spec)}
