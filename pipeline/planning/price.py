"""The cost of many images of a scenario, measured with a few images that are not kept."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import get_args

from blender_scenes.render.devices import device_for
from blender_scenes.render.frame_files import FrameFile
from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from pipeline.executors.local import Local
from pipeline.executors.part import BLOCK_FRAMES
from pipeline.planning.plan import BYTES_PER_JOB, BYTES_PER_ROW, ScenarioPlan
from pipeline.run_folder.workspace import StageFolder, Workspace
from pipeline.stages.cameras import without_further_cameras
from pipeline.stages.render import journal
from pipeline.stages.simulate_runs import simulate_runs
from pipeline.work.batch import Batch
from pipeline.work.supervisor import cores
from symolo.core.errors import InputError, RunFailed
from symolo.core.files.disk_space import check_scratch
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report, plural, seconds
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.documents.camera_specification import KIND as CAMERA
from symolo.dataset.documents.metadata import FailedRun

RUNS, IMAGES = 3, 4
"""Numbers of runs and of images of each that are measured: the cost differs between draws, hardly between images of a
run."""
DRIVE_S = 20.0
"""Simulated time [s]; the start of a simulation takes as long as several seconds of it."""
SHARD_BYTES = 1e9
HOUR_S = 3600.0


class OneCore(Local):
    """Cycles on one thread, as on a cluster whose cores are all at work."""

    def threads(self, units: int) -> int:
        del units
        return 1


@dataclass(frozen=True)
class Price:
    """The cost of one image, with its share of everything before it."""

    device: str
    """Device that rendered: CPU, or a kind of graphics card."""
    images: int
    """Number of images that were measured."""
    rows_per_image: float
    simulate_s: float
    """Time [s] on one core to simulate from one image to the next."""
    start_s: float
    """Time [s] to start Blender and to build the scene, for a block of images."""
    first_s: float
    """Extra time [s] of the first image of a block, for the maps of everything in sight."""
    render_s: float
    """Time [s] of a later image of a block, on one core or on the card."""
    annotate_s: float
    """Time [s] on one core for all annotations of an image."""
    image_bytes: float
    annotation_bytes: float

    def cost(self, images: int) -> "Cost":
        """Return the cost of that number of images."""
        block_s = self.start_s / BLOCK_FRAMES
        render_s = self.render_s + block_s + self.first_s / BLOCK_FRAMES
        bare = images * (self.image_bytes + self.rows_per_image * BYTES_PER_ROW)
        return Cost(
            images=images,
            simulate_h=images * self.simulate_s / HOUR_S,
            render_h=images * render_s / HOUR_S,
            annotate_h=images * (self.annotate_s + block_s) / HOUR_S,
            bare_bytes=bare,
            annotated_bytes=bare + images * self.annotation_bytes,
        )

    def alone_s(self, cost: "Cost") -> float:
        """Return how long this machine takes without annotations [s]."""
        on_cpu = (cost.simulate_h + cost.render_h) * HOUR_S / cores()
        return on_cpu if self.device == "CPU" else cost.render_h * HOUR_S

    def text(self, images: int, about: str) -> str:
        """Return hours, bytes and shards for that number of images as text, with the assumptions."""
        cost, unit = self.cost(images), "core" if self.device == "CPU" else f"{self.device}"
        bare, whole = cost.bare_bytes, cost.annotated_bytes
        block, annotate = f"{self.start_s + self.first_s:.3g} s per block", f"{self.annotate_s:.3g} s per image"
        lines = [
            f"{plural(images, 'image')} of {about}",
            "",
            f"simulate   {_hours(cost.simulate_h)} core-hours",
            f"render     {_hours(cost.render_h)} {unit}-hours: {self.render_s:.3g} s per image, {block}",
            f"annotate   {_hours(cost.annotate_h)} {unit}-hours more for all annotations: {annotate}",
            f"disk       {_bytes(bare)}, with all annotations {_bytes(whole)}; .stages has another",
            f"           copy, and {BYTES_PER_JOB / 1e6:.1f} MB for each run, twice with annotations",
            f"shards     {_shards(bare)} of {SHARD_BYTES / 1e9:g} GB, with all annotations {_shards(whole)}",
            f"here       about {seconds(self.alone_s(cost))} without annotations"
            + (f", on {cores()} cores" if self.device == "CPU" else ""),
        ]
        lines += [
            "",
            f"Measured on this machine with its present load: {self.images} images of {RUNS} draws from the start of",
            f"their runs, one at a time on one thread. Assumed: blocks of {BLOCK_FRAMES} images, each with a new start",
            f"of Blender, and {BYTES_PER_ROW} bytes per row of the tables. Other processors need different times.",
        ]
        if self.device == "CPU":
            lines += ["No graphics card was measured; --device gpu measures one if there is one."]
        return "\n".join(lines)


@dataclass(frozen=True)
class Cost:
    """The cost of a number of images."""

    images: int
    simulate_h: float
    """Hours of one core."""
    render_h: float
    annotate_h: float
    """Hours of one core, or of the graphics card."""
    bare_bytes: float
    """Size without annotations."""
    annotated_bytes: float
    """Size with all annotations."""


def measure(scenario: str, overrides: Sequence[str], report: Report) -> tuple[Price, str]:
    """Make a few images of a scenario with all annotations and time them; return the price and a description.

    Raises:
        InputError: The scenario cannot be used.
        EnvironmentLacking: The disk is too full, or the scenario requires a graphics card and there is none.
        RunFailed: One of the images could not be made.
    """
    hz = draw_run(loaded := load_scenario(scenario, overrides), loaded.routes[0].name, 1).rates.camera_hz
    if not hz:
        raise InputError("rates.camera_hz", got=hz, allowed="a rate above 0, since the images are timed")
    kinds = ",".join(get_args(AnnotationName))
    short = ["stop.lap=false", f"stop.time_limit_s={(IMAGES - 0.5) / hz}", f"render.annotations=[{kinds}]"]
    loaded = load_scenario(scenario, [*overrides, *short])
    routes = loaded.routes
    drawn = (draw_run(loaded, routes[i % len(routes)].name, 1 + i // len(routes)) for i in range(RUNS))
    specs = tuple(map(without_further_cameras, drawn))
    check_scratch(ScenarioPlan.from_specs(specs, 1).bytes_needed, "lower render.width_px and render.height_px")
    device = device_for(specs[0].render.device)
    with scratch_folder() as scratch:
        drive_s = _drive_s(specs[0], scratch, report) / hz
        batch = Batch(loaded, specs, Workspace(scratch), OneCore(1), device)
        price = _timed(batch, drive_s, report)
    render = specs[0].render
    further = CAMERA in draw_run(loaded, routes[0].name, 1).robot.sensors.kinds
    alone = " of the camera of data.csv, without the further cameras" if further else ""
    return price, f"{render.width_px} x {render.height_px} px, quality {render.quality}{alone}"


def _drive_s(spec: RunSpec, scratch: Path, report: Report) -> float:
    """Return the time [s] on one core for a simulated second: the difference between a long and a short drive."""
    taken = []
    for drive_s in (spec.stop.time_limit_s, spec.stop.time_limit_s + DRIVE_S):
        stop = spec.stop.model_copy(update={"time_limit_s": drive_s})
        begin = time.perf_counter()
        workspace = Workspace(scratch / f"drive_{drive_s:g}")
        _require_success(simulate_runs(workspace, [spec.model_copy(update={"stop": stop})], OneCore(1), report))
        taken.append(time.perf_counter() - begin)
    return (taken[1] - taken[0]) / DRIVE_S


def _timed(batch: Batch, simulate_s: float, report: Report) -> Price:
    batch.copy_user_images()
    _require_success(batch.simulate(report))
    simulated = time.perf_counter()
    _require_success(batch.render([], report))
    rendered = time.perf_counter()
    by_run = [_files(batch.workspace.render(spec.key), "images") for spec in batch.specs]
    image_files = [file for files in by_run for file in files]
    annotations = [file for spec in batch.specs for file in _files(batch.workspace.annotate(spec.key), "annotations")]
    images = len(image_files)
    render_s, annotate_s = (sum(file.seconds for file in files) for files in (image_files, annotations))
    first_s = sum(max(0.0, files[0].seconds - mean(file.seconds for file in files[1:])) for files in by_run)
    return Price(
        device=batch.device,
        images=images,
        rows_per_image=batch.specs[0].rates.control_hz / batch.specs[0].rates.camera_hz,
        simulate_s=simulate_s,
        start_s=max(0.0, rendered - simulated - render_s - annotate_s) / (2 * len(batch.specs)),
        first_s=first_s / len(by_run),
        render_s=(render_s - first_s) / images,
        annotate_s=annotate_s / images,
        image_bytes=sum(file.size_bytes for file in image_files) / images,
        annotation_bytes=sum(file.size_bytes for file in annotations) / images,
    )


def _files(folder: StageFolder, name: str) -> list[FrameFile]:
    return list(journal(folder, name).whole_files().values())


def _require_success(failures: Sequence[FailedRun]) -> None:
    if failures:
        raise RunFailed(f"{failures[0].run}: {failures[0].stage}: {failures[0].problem}")


def _hours(value: float) -> str:
    return f"{value:,.3g}" if value < 1000 else f"{value:,.0f}"


def _bytes(value: float) -> str:
    return f"{value / 1e12:.3g} TB" if value >= 1e12 else f"{value / 1e9:.3g} GB"


def _shards(value: float) -> int:
    return int(-(-value // SHARD_BYTES))
