"""The status of an output folder: its content, what is missing, and whether another command works in it."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

from pydantic import ValidationError

from blender_scenes.render.frame_files import Ledger
from blender_scenes.render.job_file import job_path
from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.planning.plan import ScenarioPlan
from pipeline.run_folder.changes import changes, first_changes
from pipeline.run_folder.output import MADE_BY
from pipeline.run_folder.stored_spec import parse_spec
from pipeline.run_folder.worker import Worker, worker_of
from pipeline.run_folder.workspace import FAILED, StageFolder, Workspace
from pipeline.stages.assemble import several_classes_text
from pipeline.stages.cameras import RunCamera, cameras_of
from pipeline.stages.render import IMAGES, journal
from pipeline.stages.run_tables import stage_rows
from pipeline.stages.simulate_runs import SPEC, RunOutcome, read_outcome, simulation_key
from pipeline.user_code import hashes_of_files, not_loaded
from symolo.core.errors import InputError, one_line
from symolo.core.files.atomic_files import place_of
from symolo.core.files.file_hashes import holds, missing_files
from symolo.core.files.paths import check_folder
from symolo.core.files.plain_files import FileKind, check_tree, is_plain_file, read_file
from symolo.core.progress import plural
from symolo.dataset.documents.metadata import read_metadata
from symolo.dataset.documents.scene_record import SCENE
from symolo.dataset.folder_kind import DATASETS, check_is_whole, kind_of
from symolo.dataset.layout import ANNOTATIONS, CAMERAS, SIDE, STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, read_manifest
from symolo.verification.inventory import Inventory

RUN_STAGES = ("simulate", "render", "annotate", "assemble")
"""Stages in their order."""


@dataclass(frozen=True)
class StageStatus:
    """Progress of one run in one stage."""

    stage: str
    text: str
    """Text about what is done or what failed."""
    again: str = ""
    """Reason why the next command does this stage; empty where it is done or fails again."""
    has_failed: bool = False
    """Whether it ended with a problem."""
    is_damaged: bool = False
    """Whether files of it are missing or changed; a change is detected only where every file is hashed."""


@dataclass(frozen=True)
class RunStatus:
    """Progress of one run through the stages."""

    run: str
    stages: tuple[StageStatus, ...]

    @property
    def done(self) -> bool:
        return not any(stage.again or stage.has_failed for stage in self.stages)


@dataclass(frozen=True)
class ReleaseStatus:
    """State of the released dataset in an output folder."""

    missing_lists: tuple[str, ...]
    """Lists of checksums that are missing, so that the release is not finished."""
    faults: int | None = None
    """Number of faults that `verify` would list; None where the files were not checked."""


@dataclass(frozen=True)
class ImageCost:
    """The time that the images took, without the starts of Blender."""

    images: int
    core_s: float
    planned_core_s: float | None
    """Planned time of one image, starts of Blender included; None without a scenario."""


@dataclass(frozen=True)
class FolderStatus:
    """The status of an output folder."""

    command: str
    """Command that makes such a folder, without `symolo`."""
    worker: Worker
    runs: tuple[RunStatus, ...]
    mixed: Mapping[str, str]
    """Warning by run whose frames were made on several classes of processor."""
    release: ReleaseStatus
    cost: ImageCost | None
    """Time that the images took; None where no image was rendered."""
    disk_bytes: Mapping[str, int]
    """Size of each part of the folder, the largest name first."""

    @property
    def is_damaged(self) -> bool:
        """Whether the release has faults, or files of a finished stage are missing or changed."""
        return bool(self.release.faults) or any(stage.is_damaged for run in self.runs for stage in run.stages)


def status(out: Path, specs: Sequence[RunSpec] = (), *, check: bool = False) -> FolderStatus:
    """Return the status of an output folder.

    Args:
        out: A folder that a command for datasets works in.
        specs: Runs of the scenario that would be released next; by default those that are stored.
        check: Whether to hash every file.

    Raises:
        InputError: It is no such folder.
    """
    check_folder(out, "name the folder that --out named")
    check_is_whole(out, "symolo status")
    kind = kind_of(out)
    if kind is None or kind not in DATASETS:
        what = f"contains the output of a command for {kind}" if kind else "is not an output folder of a release"
        raise InputError(what, where=str(out), cure="name the --out of release, simulate, render or assemble")
    check_tree(out, STAGES)
    workspace = Workspace(out.absolute())
    worker = worker_of(workspace)
    runs = tuple(run_status(workspace, run, spec, check=check) for run, spec in _runs(workspace, specs).items())
    names = [run.run for run in runs]
    return FolderStatus(
        command=MADE_BY[kind],
        worker=worker,
        runs=runs,
        mixed=_mixed(workspace, names),
        release=_release(workspace, check=check),
        cost=_cost(workspace, names, specs),
        disk_bytes=_disk(workspace),
    )


def again(workspace: Workspace, specs: Sequence[RunSpec]) -> Iterator[str]:
    """Yield a line for each reason why finished stages of these runs are done again."""
    reasons: Counter[str] = Counter()
    for spec in specs:
        if workspace.simulate(spec.key).done() is None:
            continue
        simulated = _simulated(workspace, spec.key, spec, check=False)
        changed = image_changes(workspace, spec.key, spec)
        if simulated.again:
            reasons[f"simulate and render again: {simulated.again}"] += 1
        elif changed and workspace.render(spec.key).done() is not None:
            reasons[f"the images there differ: {first_changes(changed)}"] += 1
    for reason, count in reasons.items():
        yield f"{plural(count, 'run')}: {reason}"


def run_status(workspace: Workspace, run: str, spec: RunSpec | None, *, check: bool = False) -> RunStatus:
    """Return the status of one run; `spec` is that of the scenario now, None without a scenario."""
    simulate = _simulated(workspace, run, spec, check=check)
    outcome = _outcome(workspace, run)
    stages = [simulate]
    if outcome is not None and not outcome.images and not outcome.problems:
        stages.append(_released(workspace, run, pending=bool(simulate.again), check=check, has_images=False))
    elif outcome is None or not outcome.problems:
        changed = [] if spec is None else image_changes(workspace, run, spec)
        for camera, images, annotated in _cameras(workspace, run, spec, outcome):
            render = _framed(workspace.render(run, camera), f"render {camera}".rstrip(), images, check=check)
            if not render.again and (changed or simulate.again):
                why = first_changes(changed) if changed else "after the simulation"
                render = StageStatus(render.stage, render.text, why)
            stages.append(render)
            if annotated or workspace.annotate(run, camera).path.exists():
                stage = f"annotate {camera}".rstrip()
                stages.append(_framed(workspace.annotate(run, camera), stage, images, check=check))
        stages.append(_released(workspace, run, pending=any(stage.again for stage in stages), check=check))
    return RunStatus(run, tuple(stages))


def _cameras(
    workspace: Workspace, run: str, spec: RunSpec | None, outcome: RunOutcome | None
) -> Iterator[tuple[str, str, bool]]:
    """Yield name, number of images and whether they are annotated of each camera of a run, as far as it is known."""
    known = spec or _read_spec(workspace.simulate(run).path / SPEC)
    if known is None:
        yield "", str(outcome.images) if outcome else "?", False
        return
    for camera in cameras_of(known):
        images = "?" if outcome is None else str(outcome.images)
        if outcome is not None and camera.name:
            images = _images_of(camera, workspace.simulate(run).path)
        yield camera.name, images, bool(spec is not None and camera.spec.render.annotations)


def _images_of(camera: RunCamera, stage: Path) -> str:
    """Return the number of images of a further camera; `stage` is the first stage of the run."""
    try:
        return str(len(camera.rows(stage_rows(stage)).t_ms))
    except (OSError, ValueError, KeyError, BadZipFile, InputError):  # damaged or gone
        return "?"


def image_changes(workspace: Workspace, run: str, spec: SceneSpec) -> list[str]:
    """Return the fields that differ between a run now and when its images were made; empty where that is unknown."""
    released = workspace.out / run / "side" / SPEC
    made = _read_spec(released) or _read_spec(workspace.simulate(run).path / SPEC)
    return [] if made is None else changes(made, spec)


def _simulated(workspace: Workspace, run: str, spec: RunSpec | None, *, check: bool) -> StageStatus:
    folder = workspace.simulate(run)
    done, stored = folder.done(), _read_spec(folder.path / SPEC)
    if done is None or stored is None:
        if not folder.path.exists() and not folder.is_begun():
            return StageStatus("simulate", "not begun", "it was never begun")
        return StageStatus("simulate", "begun", "it was never finished")
    if damage := _damage(folder.path, done.files, check=check):
        return StageStatus("simulate", "damaged", damage, is_damaged=True)
    current = spec or stored
    if not isinstance(current, RunSpec) or stored.origin is not None:
        return StageStatus("trajectory", "taken over" if stored.origin is None else stored.origin.text)
    if done.key == simulation_key(current):
        outcome = _outcome(workspace, run)
        if outcome is not None and outcome.problems:
            return StageStatus("simulate", f"failed: {one_line('; '.join(outcome.problems))}", has_failed=True)
        return StageStatus("simulate", "done")
    return StageStatus("simulate", "outdated", _why_outdated(stored, current))


def _damage(folder: Path, files: Mapping[str, str], *, check: bool) -> str:
    """Return what is wrong with the files of a finished stage, which are hashed with `check`; empty if nothing is."""
    if missing_files(folder, files):
        return "some of its files are missing"
    return "some of its files were changed" if check and not holds(folder, files) else ""


def _why_outdated(stored: RunSpec | SceneSpec, current: RunSpec) -> str:
    if changed := changes(stored, current, simulation=True):
        return first_changes(changed)
    if lacking := [*not_loaded(current)]:
        return ", ".join(lacking)
    files = "".join(f" or of the file of {name}" for name in hashes_of_files(current))
    return f"it was made with different versions of the programs{files}"


def _framed(folder: StageFolder, stage: str, total: str, *, check: bool) -> StageStatus:
    files = folder.path / (IMAGES if stage.startswith("render") else ANNOTATIONS)
    done = folder.done()
    if done is not None:
        if damage := _damage(folder.path, done.files, check=check):
            return StageStatus(stage, "damaged", damage, is_damaged=True)
        return StageStatus(stage, f"done, {_images(total)}")
    if (folder.path / FAILED).exists():
        why = one_line(folder.problem()) or "for an unknown reason"
        return StageStatus(stage, f"failed: {why}", has_failed=True)
    if not files.is_dir():
        return StageStatus(stage, "not begun", "it was never begun")
    there = str(_frames(files))
    pending = (
        "all its images are there, and still have to be checked" if there == total else "some of its images are missing"
    )
    return StageStatus(stage, f"{there} of {_images(total)}", pending)


def _images(count: str) -> str:
    """Return a number of images, which may be unknown, with its noun."""
    return plural(int(count), "image") if count.isdigit() else f"{count} images"


def _frames(files: Path) -> int:
    """Return the number of images with all their files."""
    folders = [path for path in files.iterdir() if path.is_dir()] or [files]
    return min(sum(not path.name.startswith(".") for path in folder.iterdir()) for folder in folders)


def _released(workspace: Workspace, run: str, *, pending: bool, check: bool, has_images: bool = True) -> StageStatus:
    done = workspace.assemble(run).done()
    there = (workspace.out / run).is_dir()
    if done is None:
        return StageStatus("release", "there, from deleted stages" if there else "not there", "it was not assembled")
    if not there:
        return StageStatus("release", "gone", "its folder is missing", is_damaged=True)
    if has_images and f"{SIDE}/{SCENE}" not in done.files:
        return StageStatus("release", "of an earlier version", f"{SIDE}/{SCENE} is not among its files")
    missing = missing_files(workspace.out / run, done.files)
    if missing:
        return StageStatus("release", f"without {missing[0]}", "some of its files are missing", is_damaged=True)
    if check and not holds(workspace.out / run, done.files):
        return StageStatus("release", "damaged", "some of its files were changed", is_damaged=True)
    return StageStatus("release", "done", "it is assembled again after its other stages" if pending else "")


def _runs(workspace: Workspace, specs: Sequence[RunSpec]) -> dict[str, RunSpec | None]:
    """Return all runs of the scenario, or all runs in the folder."""
    if specs:
        return {spec.key: spec for spec in specs}
    runs: set[str] = set()
    for stage in RUN_STAGES:
        root = workspace.out / STAGES / stage
        begun = [place for path in root.glob("*/.test_*.tmp") if (place := place_of(path))]
        places = [path for path in root.glob("*/test_*") if path.is_dir()]
        runs |= {path.relative_to(root).as_posix() for path in begun + places}
    metadata = read_metadata(workspace.out)
    runs |= {record.run for record in metadata.runs} if metadata else set()
    return dict.fromkeys(sorted(runs, key=in_order))


def in_order(run: str) -> tuple[str, int]:
    """Return the key by which runs are sorted: their route and number."""
    route, _, number = run.partition("/test_")
    return route, int(number) if number.isdigit() else 0


def missing_lists(workspace: Workspace) -> tuple[str, ...]:
    """Return the names of the lists of checksums that are missing, so that the release is not finished."""
    return tuple(name for name in (MANIFEST, TAG_MANIFEST) if not is_plain_file(workspace.out / name))


def missing_from_release(workspace: Workspace) -> Sequence[str]:
    """Return the missing lists of checksums or, where both are there, the missing files that they name."""
    if lists := missing_lists(workspace):
        return lists
    try:
        return missing_files(workspace.out, read_manifest(read_file(workspace.out / MANIFEST, FileKind.CHECKSUMS)))
    except (OSError, ValueError):  # damaged, so that the next release writes it again
        return (MANIFEST,)


def _release(workspace: Workspace, *, check: bool) -> ReleaseStatus:
    missing = missing_lists(workspace)
    if missing or not check:
        return ReleaseStatus(missing)
    return ReleaseStatus(missing, sum(1 for _ in Inventory.from_folder(workspace.out).findings()))


def _cost(workspace: Workspace, runs: Sequence[str], specs: Sequence[RunSpec]) -> ImageCost | None:
    images, core_s = 0, 0.0
    for run in runs:
        for name, ledger in _journals(workspace, run):
            files = ledger.files()
            core_s += sum(file.seconds * file.threads for file in files)
            images += len({file.file for file in files}) if name == IMAGES else 0
    if not images:
        return None
    planned = ScenarioPlan.from_specs(specs, 1) if specs else None
    return ImageCost(images, core_s, planned.render_s / planned.images if planned else None)


def _mixed(workspace: Workspace, runs: Sequence[str]) -> dict[str, str]:
    """Return a warning for each run whose frames were made on several classes of processor."""
    classes = {run: {cpu for _, ledger in _journals(workspace, run) for cpu in ledger.processors()} for run in runs}
    return {run: several_classes_text(sorted(cpus)) for run, cpus in classes.items() if len(cpus) > 1}


def _journals(workspace: Workspace, run: str) -> Iterator[tuple[str, Ledger]]:
    """Yield the journals of the images and annotations of a run, with the name of their folder."""
    further = workspace.out / STAGES / CAMERAS
    for camera in ("", *(sorted(path.name for path in further.iterdir()) if further.is_dir() else ())):
        for folder, name in ((workspace.render(run, camera), IMAGES), (workspace.annotate(run, camera), ANNOTATIONS)):
            if job_path(folder.path).is_file():
                yield name, journal(folder, name)


def _disk(workspace: Workspace) -> dict[str, int]:
    sizes: Counter[str] = Counter()
    for folder, _, files in os.walk(workspace.out):
        inner = Path(folder).relative_to(workspace.out).parts
        part = "release" if inner[:1] != (STAGES,) else "/".join(inner[:2])
        for name in files:
            try:
                sizes[part] += os.lstat(os.path.join(folder, name)).st_size  # noqa: PTH118 - of many files
            except OSError:  # gone meanwhile
                continue
    return dict(sorted(sizes.items(), reverse=True))


def _outcome(workspace: Workspace, run: str) -> RunOutcome | None:
    try:
        return read_outcome(workspace.simulate(run).path)
    except (OSError, ValidationError):
        return None


def _read_spec(path: Path) -> SceneSpec | None:
    try:
        return parse_spec(read_file(path, FileKind.DOCUMENT))
    except (OSError, ValidationError):
        return None
