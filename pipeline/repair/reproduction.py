"""`symolo verify --reproduce`: images drawn at random and rendered again, to be compared with those of the dataset."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.repair.descriptions import machine_differences
from pipeline.repair.frames import check_user_images, only_frames, render_tasks, write_job
from pipeline.repair.repair_state import recorded_device
from pipeline.run_folder.stored_spec import read_spec
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import FrameTask, RenderTask
from symolo.compare.images import likeness
from symolo.compare.likeness import shown_db
from symolo.core.errors import InputError, one_line
from symolo.core.files.plain_files import FileKind, check_tree, read_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.dataset.bag import read_cpu_classes
from symolo.dataset.documents.metadata import METADATA, Metadata, RunRecord, made_with
from symolo.dataset.layout import DATA, IMAGES, SIDE, SPEC, STAGES, camera_folder, frame_name
from symolo.dataset.tables.rows import read_rows


@dataclass(frozen=True)
class ReproducedImage:
    """One image that was rendered again."""

    file: str
    """Path in the dataset."""
    problem: str = ""
    """Difference from the released image, or why it could not be rendered; empty where the bytes are the same."""
    is_missing: bool = False
    """Whether it could not be rendered."""

    def __str__(self) -> str:
        return one_line(f"{self.file}: {self.problem or 'the same bytes'}")


@dataclass(frozen=True)
class Reproduction:
    """The result for all images that were drawn."""

    images: tuple[ReproducedImage, ...]
    difference: str
    """Why equal bytes cannot be expected on this machine; empty where they can."""

    @property
    def unequal(self) -> tuple[ReproducedImage, ...]:
        return tuple(image for image in self.images if image.problem)


def reproduce(root: Path, count: int, seed: int, workers: int, report: Report) -> Reproduction:
    """Render images of a dataset without a fault again, from its specifications and poses, and compare the bytes.

    Args:
        root: The dataset.
        count: Number of images; all of them where there are fewer.
        seed: Seed of the draw.
        workers: Number of child processes at a time.
        report: Progress report.

    Raises:
        EnvironmentLacking: Blender does not start, or a graphics card is not there.
    """
    check_tree(root, f"{STAGES}/assets")
    metadata = Metadata.model_validate_json(read_file(root / METADATA, FileKind.DOCUMENT))
    chosen = drawn_images(metadata, count, seed)
    difference = _difference(root, metadata, chosen)
    if difference:
        report.say(f"reproduce: equal bytes cannot be expected: {difference}")
    images: list[ReproducedImage] = []
    tasks: list[FrameTask] = []
    with scratch_folder() as scratch:
        for drawn in chosen:
            try:
                tasks.append(_prepared(root, drawn, scratch))
            except InputError as error:
                problem = f"cannot be rendered again: {error}"
                names = [_name(drawn.record.run, drawn.camera, number) for number in drawn.numbers]
                images += [ReproducedImage(name, problem, is_missing=True) for name in names]
        render_tasks(tasks, workers, report)
        for task in tasks:
            images += [_compared(root, task, frame.number) for frame in task.frames]
    return Reproduction(tuple(sorted(images, key=lambda image: image.file)), difference)


@dataclass(frozen=True)
class DrawnImages:
    """Images of a camera of a run that were drawn."""

    record: RunRecord
    camera: str
    """Name of a further camera; empty for that of data.csv."""
    numbers: tuple[int, ...]

    @property
    def device(self) -> str:
        """Device that rendered them, as metadata.json names it."""
        return self.record.cameras[self.camera].render_device if self.camera else self.record.render_device


def drawn_images(metadata: Metadata, count: int, seed: int) -> list[DrawnImages]:
    """Return images that were drawn, each image of the dataset as likely."""
    cameras = [(record, camera) for record in metadata.runs for camera in ("", *record.cameras)]
    every = [
        (place, number)
        for place, (record, camera) in enumerate(cameras)
        for number in range(1, (record.cameras[camera].images if camera else record.images) + 1)
    ]
    picked: dict[int, list[int]] = {}
    for chosen in sorted(stream(seed, "verify", "reproduce").permutation(len(every))[:count].tolist()):
        place, number = every[chosen]
        picked.setdefault(place, []).append(number)
    return [DrawnImages(*cameras[place], tuple(numbers)) for place, numbers in picked.items()]


def _difference(root: Path, metadata: Metadata, chosen: Sequence[DrawnImages]) -> str:
    texts = [machine_differences(metadata.made_with, read_cpu_classes(root), made_with())]
    if cards := sorted({drawn.device for drawn in chosen} - {"CPU"}):
        texts.append(f"it was rendered on {' and '.join(cards)}, which does not promise equal bytes")
    return "; ".join(filter(None, texts))


def _prepared(root: Path, drawn: DrawnImages, scratch: Path) -> FrameTask:
    run = drawn.record.run
    spec, user_files = read_spec(root / run / SIDE / SPEC), Workspace(root.absolute()).user_files
    check_user_images(spec, user_files)
    camera = next((one for one in cameras_of(spec) if one.name == drawn.camera), None)
    if camera is None:
        raise InputError(f"its specification has no camera {drawn.camera}")
    rows, folder = read_rows(root / run / DATA), Workspace(scratch).render(run, drawn.camera)
    frame_job = RenderTask.of_camera(camera, rows, folder, user_files, recorded_device(drawn.device))
    write_job(frame_job)
    return only_frames(frame_job.task, [frame_name(number) for number in drawn.numbers])


def _compared(root: Path, task: FrameTask, number: int) -> ReproducedImage:
    file = _name(task.run, task.camera, number)
    try:
        again = read_file(task.files / frame_name(number), FileKind.IMAGE)
    except FileNotFoundError:
        return ReproducedImage(file, "could not be rendered again", is_missing=True)
    released = read_file(root / file, FileKind.IMAGE)
    if again == released:
        return ReproducedImage(file)
    difference = likeness(released, again, file)
    level = shown_db(difference.level_db)
    return ReproducedImage(file, f"differs when it is rendered again ({level}): {difference.what}")


def _name(run: str, camera: str, number: int) -> str:
    folder = f"{run}/{camera_folder(camera)}" if camera else run
    return f"{folder}/{IMAGES}/{frame_name(number)}"
