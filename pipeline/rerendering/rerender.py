"""Images for an existing trajectory, one of symolo or a SyMoLo data.csv from elsewhere; nothing is simulated."""

import contextlib
import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from blender_scenes.render.devices import device_for
from configs.draw import draw_arena, draw_look, draw_render, draw_robot
from configs.loader import load_scenario, load_section
from configs.overrides import replaced_section
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render, SceneSpec
from pipeline.assembly.scene_file import scene_file
from pipeline.executors.base import Executor
from pipeline.importing.suspicions import check_possible
from pipeline.planning.plan import BYTES_PER_JOB, image_bytes
from pipeline.rerendering.unit_checks import check_on_the_floor
from pipeline.run_folder.output import check_out
from pipeline.run_folder.stored_runs import read_simulated
from pipeline.run_folder.stored_spec import read_spec
from pipeline.run_folder.user_files import keep_user_files
from pipeline.run_folder.workspace import Workspace, input_key, mark_done
from pipeline.stages.annotate import AnnotationTask, copy_released
from pipeline.stages.assemble import copy_images
from pipeline.stages.render import (
    FRAMES,
    IMAGES,
    Appearance,
    FrameTask,
    Order,
    RenderTask,
    image_seed,
    render_runs,
)
from pipeline.stages.simulate_runs import SPEC, TRAJECTORY
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, move, remove_file, remove_folder, replace_folder, write_file
from symolo.core.files.disk_space import check_disk
from symolo.core.files.file_hashes import canonical_json, hashes_of, holds
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.lens import lens_problem
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.dataset.documents.camera_model import camera_files
from symolo.dataset.documents.metadata import FailedRun
from symolo.dataset.folder_kind import Kind
from symolo.dataset.layout import ANNOTATIONS, DATA, JOB, LOOK, POSITIONS, SIDE
from symolo.dataset.tables.rows import HEADER, Ints, Rows, read_rows
from symolo.dataset.tables.side_tables import image_positions

CARRIER = "symolo"
"""The scenario that checks `--set render...` and gives a foreign trajectory its image settings."""

SECTIONS = ("look", "render", "arena", "robot")


@dataclass(frozen=True)
class RerenderRequest:
    """The options of `symolo rerender` that say what is rendered."""

    looks: tuple[str, ...]
    draws: int = 1
    """Number of draws of each look."""
    arena: str | None = None
    robot: str | None = None
    camera_hz: float | None = None
    seed: int | None = None
    overrides: tuple[str, ...] = ()
    option: str = "--look"
    """Option that names the looks."""

    def named_by(self, section: str) -> str:
        """Return the option that names this section; empty where none does."""
        named = {"look": self.option, "arena": self.arena and "--arena", "robot": self.robot and "--robot"}
        return named.get(section) or ""

    def overrides_of(self, section: str) -> tuple[str, ...]:
        """Return the overrides of one section."""
        return tuple(text for text in self.overrides if text.strip().startswith((f"{section}.", f"{section}=")))


@dataclass(frozen=True)
class StoredTrajectory:
    """A trajectory, with the specification of its run if there is one."""

    rows: Rows
    data: bytes
    """Content of data.csv."""
    spec: SceneSpec | None
    """Specification of the run; None for a data.csv from elsewhere."""
    file: Path
    """File from which it was read."""

    def at(self, row: int) -> str:
        """Return the place of a row for error messages."""
        return f"{self.file}, row {row}" if self.file.name == TRAJECTORY else f"{self.file}:{row + 2}"


@dataclass(frozen=True)
class LookDraw:
    """One set of images: a look with drawn values."""

    name: str
    """Name of its folder, `<look>_<k>`, k from 1."""
    appearance: Appearance
    record: bytes
    """Content of look.json."""
    assets: Mapping[str, Path]
    """Paths of the user's files of the look, by SHA-256."""


def folder_name(source: StoredTrajectory, draws: Sequence[LookDraw]) -> str:
    """Return the default name of the output folder: run and looks; a run of symolo by route and number, others by
    their file.
    """
    file = source.file.resolve()
    run = source.spec.key.replace("/", "-") if source.spec else file.parent.name if file.name == DATA else file.stem
    return "-".join((run or "run", *dict.fromkeys(draw.appearance.look.name for draw in draws)))


def check_same(source: StoredTrajectory, draws: Sequence[LookDraw], out: Path, *, in_subfolders: bool) -> None:
    """Refuse a default folder that holds images of something else.

    Raises:
        InputError: It holds images of another trajectory or draw.
    """
    for draw in draws:
        folder = out / draw.name if in_subfolders else out
        for name, wanted in ((DATA, source.data), (LOOK, draw.record)):
            if (folder / name).is_file() and read_file(folder / name, FileKind.ANY) != wanted:
                what = "contains images of a different trajectory or a different draw of the look"
                raise InputError(what, where=str(folder), cure="name a folder with --out")


@contextlib.contextmanager
def open_folders(
    source: StoredTrajectory, draws: Sequence[LookDraw], out: Path, *, in_subfolders: bool
) -> Iterator[list[Workspace]]:
    """Yield a checked and locked folder for each draw: `out/<name>` for draws of `--looks`, else `out` for the only
    one.

    Raises:
        InputError: One of them cannot be used, or another command works in it.
        EnvironmentLacking: The disk is too full.
    """
    kind = Kind.LOOKS if in_subfolders else Kind.PICTURES
    check_out(out, kind)
    whole = Workspace(out.absolute(), kind)
    folders = [Workspace(whole.out / draw.name, Kind.PICTURES) for draw in draws] if in_subfolders else [whole]
    for folder in folders:
        check_out(folder.out, Kind.PICTURES, within_looks=in_subfolders)
    check_disk(out, sum(_bytes_needed(source, draw) for draw in draws))
    with whole.locked():
        for folder in folders if in_subfolders else ():
            with folder.locked():  # released at once: a process has about a thousand file descriptors
                pass
        yield folders


def render_source(
    source: StoredTrajectory,
    draws: Sequence[LookDraw],
    folders: Sequence[Workspace],
    executor: Executor,
    report: Report,
) -> list[FailedRun]:
    """Render and annotate the draws of `prepare`, and fill a folder with each of them."""
    places = {draw.name: (draw, folder) for draw, folder in zip(draws, folders, strict=True)}
    for draw, folder in places.values():
        keep_user_files((draw.appearance.look,), draw.assets, folder.user_files)
    images: dict[str, FrameTask] = {}
    annotations: dict[str, FrameTask] = {}

    def image_orders() -> Iterator[Order]:
        for name, (draw, folder) in places.items():
            order = RenderTask.of(name, draw.appearance, source.rows, folder.render("rerender"), folder.user_files)
            images[name] = order.task
            yield order

    def annotation_orders() -> Iterator[Order]:
        for name, (draw, folder) in places.items():
            if draw.appearance.render.annotations and name not in failed:
                order = AnnotationTask.of(images[name], draw.appearance, folder.annotate("rerender"))
                annotations[name] = order.task
                yield order

    failures = render_runs(image_orders(), executor, report)
    failed = {failure.run for failure in failures}
    failures += render_runs(annotation_orders(), executor, report, "annotate")
    failed = {failure.run for failure in failures}
    for name, (draw, folder) in places.items():
        if name not in failed:
            _publish(images[name], annotations.get(name), _descriptions(source, draw), folder)
    return failures


def _bytes_needed(source: StoredTrajectory, draw: LookDraw) -> int:
    render, images = draw.appearance.render, int(np.count_nonzero(source.rows.image))
    pixels = images * render.width_px * render.height_px
    # The job is in the folder once more, beside the trajectory.
    return image_bytes(images, pixels, annotated=bool(render.annotations)) + BYTES_PER_JOB + len(source.data)


def draw_seed(seed: int, draw: int) -> int:
    """Return the seed of a look's values, stains and noise in one draw; the first draw has that of the run."""
    return seed if draw == 1 else int(stream(seed, "rerender", draw).integers(2**53))


def prepare(source: Path, request: RerenderRequest) -> tuple[StoredTrajectory, tuple[LookDraw, ...]]:
    """Read and check everything before anything is written, and return all draws of the first look, then those of the
    next.

    Raises:
        InputError: The trajectory, the look or another part of the request cannot be used.
        EnvironmentLacking: A graphics card is required and there is none.
    """
    for text in request.overrides:
        if text.strip().partition("=")[0].partition(".")[0] not in SECTIONS:
            raise InputError(
                "--set",
                got=text,
                allowed="fields of " + ", ".join(SECTIONS),
                cure="to change other fields, simulate again",
            )
        if option := request.named_by(replaced_section(text)):
            raise InputError("--set", got=text, cure=f"name it with {option}")
    trajectory = _timed(read_source(source), request.camera_hz)
    draws = _draws(trajectory, request)
    if trajectory.spec is None or request.arena:
        arena = Arena.from_config(draws[0].appearance.arena)
        for draw in draws:
            check_on_the_floor(trajectory.rows, arena, draw.appearance.look, trajectory.at)
    if trajectory.spec is None:  # places in millimetres are fast, too, but outside the room
        rows = trajectory.rows
        check_possible(rows.t_ms / 1000, rows.pose, trajectory.at, in_milliseconds=True)
    return trajectory, draws


def read_source(path: Path) -> StoredTrajectory:
    """Read a run folder of a dataset or of `.stages`, or a single data.csv."""
    cure = "make the run again, or rerender its data.csv with --arena and --robot"
    folder = path.parent if path.name == DATA else path
    if path.is_dir() and (folder / TRAJECTORY).is_file():
        rows = Rows.from_recording(read_simulated(folder))
        return StoredTrajectory(rows, rows.to_csv(), read_spec(folder / SPEC, cure), folder / TRAJECTORY)
    data = path.resolve() if path.is_file() else folder / DATA  # only what the user names may be a link
    if not data.is_file():
        cure = "name a folder such as OUT/CW/test_1, or a data.csv"
        raise InputError("is neither a run folder nor a data.csv", where=str(path), cure=cure)
    side = folder / SIDE / SPEC
    spec = read_spec(side, cure) if data.name == DATA and side.is_file() else None
    return StoredTrajectory(read_rows(data), read_file(data, FileKind.TABLE), spec, data)


def _timed(source: StoredTrajectory, camera_hz: float | None) -> StoredTrajectory:
    """Return the trajectory with image numbers at `camera_hz`, or those of data.csv where it is None."""
    if camera_hz is None:
        if np.any(source.rows.image > 0):
            return source
        raise InputError(
            "data.csv",
            got="img 0 in every row",
            allowed="at least one image",
            cure="choose a rate, such as --camera-hz 5",
        )
    columns = tuple(name for name in HEADER if name in {*source.rows.columns, "img"})
    rows = replace(source.rows, image=image_numbers(source.rows.t_ms, camera_hz), columns=columns)
    return replace(source, rows=rows, data=rows.to_csv())


def image_numbers(t_ms: Ints, camera_hz: float) -> Ints:
    """Return (N,): 1, 2, 3... at the first row of every camera period since the first row, 0 elsewhere."""
    period = np.floor((t_ms - t_ms[0]) * camera_hz / 1000 + 1e-9)
    first = np.concatenate(([True], np.diff(period) > 0))
    return np.where(first, np.cumsum(first), 0)


def _draws(source: StoredTrajectory, request: RerenderRequest) -> tuple[LookDraw, ...]:
    """Draw all looks; arena, robot and image settings are the same in all draws."""
    spec = source.spec
    route, run = spec.drawn_as if spec else ("foreign", 1)
    seed = request.seed if request.seed is not None else spec.seed if spec else 1
    arena = _arena(source, request, seed, route, run)
    robot = _robot(spec, request, seed, route, run)
    render = _render(spec, request, seed, route, run)
    if problem := lens_problem(robot.camera, render.width_px, render.height_px):
        raise InputError(
            f"robot.camera.distortion: {problem}", cure="use smaller coefficients or a longer focal length"
        )
    draws, device = [], device_for(render.device)
    for name in request.looks:
        section = load_section("look", name, request.overrides_of("look"), request.option)
        for k in range(1, request.draws + 1):
            look_seed = draw_seed(seed, k)
            look, drawn = draw_look(section, look_seed, route, run)
            record = {"draw": k, "seed": look_seed, "drawn": drawn, "look": look.model_dump(mode="json")}
            appearance = Appearance(arena, robot, look, render, image_seed(look_seed, route, run), device)
            draws.append(LookDraw(f"{look.name}_{k}", appearance, canonical_json(record), section.assets))
    names = [draw.name for draw in draws]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError(
            "--looks", got=twice[0].rpartition("_")[0], allowed="each look once, and no two looks of the same name"
        )
    return tuple(draws)


def _arena(source: StoredTrajectory, request: RerenderRequest, seed: int, route: str, run: int) -> ArenaConfig:
    if source.spec and not request.arena:
        _refuse_overrides(request, "arena")
        return source.spec.arena
    section = load_section("arena", request.arena or "symolo", request.overrides_of("arena"))
    x_m, y_m, yaw_rad = source.rows.pose[0].tolist()
    return draw_arena(section, seed, route, run, start=(x_m, y_m, yaw_rad))[0]


def _robot(spec: SceneSpec | None, request: RerenderRequest, seed: int, route: str, run: int) -> RobotConfig:
    if spec and not request.robot:
        _refuse_overrides(request, "robot")
        return spec.robot
    return draw_robot(
        load_section("robot", request.robot or "nominal", request.overrides_of("robot")), seed, route, run
    )[0]


def _refuse_overrides(request: RerenderRequest, section: str) -> None:
    if request.overrides_of(section):
        raise InputError(
            "--set", got=request.overrides_of(section)[0], allowed="look or render", cure=f"name --{section} as well"
        )


def _render(spec: SceneSpec | None, request: RerenderRequest, seed: int, route: str, run: int) -> Render:
    stored = spec.render.model_dump(mode="json", exclude_none=True) if spec else {}
    settings = [f"render.{name}={str(value).lower()}" for name, value in stored.items()]
    return draw_render(load_scenario(CARRIER, [*settings, *request.overrides_of("render")]), seed, route, run)


def _descriptions(source: StoredTrajectory, draw: LookDraw) -> dict[str, bytes]:
    """Return the files that describe the images, by path."""
    tables = {DATA: source.data, POSITIONS: image_positions(source.rows), LOOK: draw.record}
    shown = draw.appearance
    return tables | dict((*camera_files(shown, source.rows), scene_file(shown.arena, shown.look, shown.seed)))


def _publish(task: FrameTask, annotations: FrameTask | None, texts: Mapping[str, bytes], workspace: Workspace) -> None:
    """Fill the folder; frames.json, the list of the images, is removed first and written last: it marks a complete
    set.
    """
    out, marker = workspace.out, workspace.assemble("rerender")
    digests = {name: hashlib.sha256(data).hexdigest() for name, data in texts.items()}
    key = input_key("pictures", render=task.key, annotate=annotations.key if annotations else "", texts=digests)
    done = marker.done()
    if done is not None and done.key == key and holds(out, done.files):
        return
    partial = marker.start()
    _fill(task, annotations, texts, partial)
    hashes = hashes_of(partial)
    remove_file(out / FRAMES)
    replace_folder(partial / IMAGES, out / IMAGES)
    remove_folder(out / ANNOTATIONS)
    if annotations:
        replace_folder(partial / ANNOTATIONS, out / ANNOTATIONS)
    replace_folder(partial / SIDE, out / SIDE)
    for name in (DATA, POSITIONS, JOB, LOOK, FRAMES):
        move(partial / name, out / name)
    make_folder(marker.path)
    mark_done(marker.path, key, hashes)
    remove_folder(partial)


def _fill(task: FrameTask, annotations: FrameTask | None, texts: Mapping[str, bytes], folder: Path) -> None:
    for name in (IMAGES, SIDE):
        make_folder(folder / name)
    copy_images(task.folder.path, task.folder.files(), folder)
    if annotations:
        copy_released(annotations.folder, folder)
    for name, data in texts.items():
        write_file(folder / name, data)
    for name in (JOB, FRAMES):
        write_file(folder / name, read_file(task.folder.path / name, FileKind.ANY))
