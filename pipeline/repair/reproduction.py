"""`symolo verify --reproduce`: images drawn at random and rendered again, to be compared with those of the dataset."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.devices import DeviceKind
from pipeline.repair.descriptions import machine_differences
from pipeline.repair.frames import check_user_files, only_frames, render_tasks, write_job
from pipeline.repair.repair_state import recorded_device
from pipeline.run_folder.stored_spec import read_spec
from pipeline.run_folder.workspace import StageFolder, Workspace
from pipeline.stages.render import Appearance, FrameTask, RenderTask
from symolo.compare.images import likeness
from symolo.compare.likeness import shown_db
from symolo.core.errors import InputError, one_line
from symolo.core.files.plain_files import FileKind, check_tree, read_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.dataset.bag import read_cpu_classes
from symolo.dataset.documents.metadata import METADATA, Metadata, RunRecord, made_with
from symolo.dataset.layout import DATA, IMAGES, SIDE, SPEC, STAGES, frame_name
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
        for record, numbers in chosen:
            device = recorded_device(record.render_device)
            try:
                tasks.append(_prepared(root, record.run, numbers, device, scratch))
            except InputError as error:
                problem = f"cannot be rendered again: {error}"
                images += [ReproducedImage(_name(record.run, n), problem, is_missing=True) for n in numbers]
        render_tasks(tasks, workers, report)
        for task in tasks:
            images += [_compared(root, task, frame.number) for frame in task.frames]
    return Reproduction(tuple(sorted(images, key=lambda image: image.file)), difference)


def drawn_images(metadata: Metadata, count: int, seed: int) -> list[tuple[RunRecord, tuple[int, ...]]]:
    """Return the runs with the numbers of their images that were drawn, each image of the dataset as likely."""
    every = [(record, number) for record in metadata.runs for number in range(1, record.images + 1)]
    places = stream(seed, "verify", "reproduce").permutation(len(every))[:count]
    picked: dict[str, list[int]] = {}
    for place in sorted(places.tolist()):
        record, number = every[place]
        picked.setdefault(record.run, []).append(number)
    return [(record, tuple(picked[record.run])) for record in metadata.runs if record.run in picked]


def _difference(root: Path, metadata: Metadata, chosen: Sequence[tuple[RunRecord, tuple[int, ...]]]) -> str:
    texts = [machine_differences(metadata.made_with, read_cpu_classes(root), made_with())]
    if cards := sorted({record.render_device for record, _ in chosen} - {"CPU"}):
        texts.append(f"it was rendered on {' and '.join(cards)}, which does not promise equal bytes")
    return "; ".join(filter(None, texts))


def _prepared(root: Path, run: str, numbers: Sequence[int], device: DeviceKind, scratch: Path) -> FrameTask:
    spec, user_files = read_spec(root / run / SIDE / SPEC), Workspace(root.absolute()).user_files
    check_user_files(spec, user_files)
    rows = read_rows(root / run / DATA)
    order = RenderTask.of(run, Appearance.of(spec, device), rows, StageFolder(scratch / run), user_files)
    write_job(order)
    return only_frames(order.task, [frame_name(number) for number in numbers])


def _compared(root: Path, task: FrameTask, number: int) -> ReproducedImage:
    file = _name(task.run, number)
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


def _name(run: str, number: int) -> str:
    return f"{run}/{IMAGES}/{frame_name(number)}"
