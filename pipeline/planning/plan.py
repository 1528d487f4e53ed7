"""Estimates of what a scenario makes, its size and its time, with the assumptions behind them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from textwrap import wrap

from blender_scenes.render.probe import LADDER, probed_numbers
from blender_scenes.render.sampling import TracingSettings, rendering_of, tracing_settings
from configs.posterior.schema import LoadedPosterior
from configs.schema.scenario import RunSpec
from pipeline.planning.demands import demand_lines, source_line
from pipeline.run_warnings.simulated_run import plan_warnings, start_to_line
from pipeline.stages.cameras import RunCamera, cameras_of
from sensors.camera.lens_warp import pinhole_image
from symolo.core.geometry.pinhole import intrinsics
from symolo.core.progress import plural, seconds
from symolo.dataset.documents.rendering_record import LightPathsRecord

WIDTH = 118
"""Longest line of the assumptions, in characters."""
LAP_S = 40.0
"""Simulated time [s] of a lap of the shipped arena; others differ."""
REAL_TIME_FACTOR = 7.0
"""Simulated seconds per second and core, as README.md and docs/dataset.md state it."""
RENDER_START_S = 6.0
"""Time [s] on one core to start the command and Blender and to build the scene, for each run
(docs/rendering_time.md#what-plan-assumes, as for the time of a sample)."""
RENDER_FRAME_S = 0.05
"""Time [s] on one core for an image, beside that for its pixels."""
RENDER_SAMPLE_S = 1e-5
"""Time [s] on one core for a sample of a pixel, with the light paths `standard`."""
CAUSTICS_TIMES = 1.25
"""Ratio of the time of a sample with caustics, as the light paths `complete` have them, to that of one without."""
DENOISE_S = {"FAST": 4e-6, "ACCURATE": 2e-5}
"""Time [s] on one core to denoise a pixel, by the prefilter of the denoiser's guides."""
BYTES_PER_PIXEL = 0.2
"""Size [byte] of a pixel of a JPEG image of quality 92."""
HYBRID_FRAME_S, HYBRID_PIXEL_S = 0.8, 3.7e-6
"""Time [s] on one core for an image from hybrid rendering, and for each of its pixels; with its share of the maps."""
_PREFILTER = LADDER[0].prefilter
"""Prefilter of the denoiser's guides in full rendering of a run that chooses."""
PROBED_SAMPLES, HYBRID_PROBED_SAMPLES = 51, 4
"""Samples of a pixel of each image from which a run chooses. With full rendering: four references of 8, because
candidates are refused from 8 on, and candidates with 2, 4 and 8, whose denoiser takes the time of 1.6 each; 8 was the
median of five shipped looks (2 to 64, docs/rendering_measurements.md). With hybrid rendering: four references of 1, as
in the three runs with it that were measured. Noisy references take more."""
ANNOTATION_PIXEL_S = 1.5e-6
"""Time [s] on one core for all annotations of a pixel."""
ANNOTATION_BYTES_PER_PIXEL = 0.6
"""Size [byte] of all annotations of a pixel; the flow alone takes nine tenths of it."""
BYTES_PER_IMAGE = 4096
"""Size [byte] of an image beside its pixels: tables, and the unused rest of a disk block."""
BYTES_PER_JOB = 500_000
"""Size [byte] of the packed job of a run: the scene as text, with the poses. With the poses of 200 images, it was 0.14
to 0.63 MB in 30 random rooms."""
BYTES_PER_ROW = 600
"""Size [byte] of a row in data.csv, side files and the stored trajectory."""
COPIES = 2
"""Number of copies: the stages keep the files of the release, so that the next command continues."""


PER_PIXEL = " samples per pixel"


@dataclass(frozen=True)
class PlannedRun:
    """Size and cost of one run before it is made."""

    run: str
    duration_s: float
    lap: bool
    rows: int
    images: int
    width_px: int
    height_px: int
    annotated: bool
    quality: str
    sampling: TracingSettings
    margin: float
    """Ratio of the traced pixels to those of the image; larger than 1 behind a lens."""
    render_core_s: float
    """Core-seconds of rendering."""
    full_core_s: float
    """Core-seconds of rendering without hybrid rendering, if the run chooses that it is too inexact."""
    start_to_line: str
    """Distance of the start from the line, and angle of its heading to the line; empty without a line, and for the
    images of further cameras."""

    @property
    def dataset_bytes(self) -> int:
        """Disk space [byte] in the dataset, without the stages."""
        pixels = self.images * self.width_px * self.height_px
        return _one_copy(self.images, pixels, annotated=self.annotated) + self.rows * BYTES_PER_ROW

    @property
    def bytes_needed(self) -> int:
        """Disk space [byte], stages included."""
        jobs = (1 + self.annotated) * BYTES_PER_JOB if self.images else 0
        return COPIES * self.dataset_bytes + jobs


def image_bytes(images: int, pixels: int, *, annotated: bool) -> int:
    """Return the disk space [byte] of a run's images, of `pixels` pixels in all, with the jobs that render them."""
    return COPIES * _one_copy(images, pixels, annotated=annotated) + (1 + annotated) * BYTES_PER_JOB


def _one_copy(images: int, pixels: int, *, annotated: bool) -> int:
    per_pixel = BYTES_PER_PIXEL + (ANNOTATION_BYTES_PER_PIXEL if annotated else 0.0)
    return round(pixels * per_pixel + images * BYTES_PER_IMAGE)


@dataclass(frozen=True)
class ScenarioPlan:
    """Size and cost of all runs of a scenario."""

    runs: tuple[PlannedRun, ...]
    """The runs with the images of the camera of data.csv."""
    cameras: tuple[PlannedRun, ...]
    """The images of the further cameras, without rows."""
    cores: int
    """Number of cores of the machine."""
    workers: int | None = None
    """Number of worker processes; None for one per core."""
    robots: str = ""
    """Source of the robots, if a scenario draws them from a diagnosis."""
    demands: tuple[str, ...] = ()
    """Lines about demands of the scenario that leave what this diagnosis measured."""
    warnings: tuple[str, ...] = ()
    """Warnings about suspicious starts, lines and walls, each with the runs that it concerns."""

    @classmethod
    def from_specs(
        cls,
        specs: Sequence[RunSpec],
        cores: int,
        like: LoadedPosterior | None = None,
        workers: int | None = None,
        replaced_draws: Sequence[str] = (),
    ) -> "ScenarioPlan":
        cameras = [(spec, camera) for spec in specs for camera in cameras_of(spec) or [RunCamera("", spec, 0.0)]]
        planned = [(camera.name, _planned(spec, camera)) for spec, camera in cameras]
        runs = tuple(run for name, run in planned if not name)
        further = tuple(replace(run, rows=0) for name, run in planned if name)
        robots = source_line(like, replaced_draws)
        return cls(runs, further, cores, workers, robots, demand_lines(like, specs), plan_warnings(specs))

    def notes(self) -> Iterator[str]:
        """Yield what a user should know before the runs are simulated."""
        if self.robots:
            yield f"robots: {self.robots}"
        yield from (f"beyond what was measured: {line}" for line in self.demands)
        yield from (f"warning: {line}" for line in self.warnings)

    @property
    def _all(self) -> tuple[PlannedRun, ...]:
        return (*self.runs, *self.cameras)

    @property
    def images(self) -> int:
        return sum(run.images for run in self._all)

    @property
    def bytes_needed(self) -> int:
        """Disk space [byte] with some reserve, stages included."""
        return sum(run.bytes_needed for run in self._all)

    @property
    def dataset_bytes(self) -> int:
        """Disk space [byte] of the dataset without the stages."""
        return sum(run.dataset_bytes for run in self._all)

    @property
    def simulation_s(self) -> float:
        at_a_time = min(self.cores, self.workers or self.cores, len(self.runs))
        return sum(run.duration_s for run in self.runs) / REAL_TIME_FACTOR / at_a_time

    @property
    def render_s(self) -> float:
        return self._on_all_cores(sum(run.render_core_s for run in self._all))

    def _on_all_cores(self, core_s: float) -> float:
        # Fewer workers have several threads each.
        workers = min(self.cores, self.workers or self.cores)
        return core_s / (workers * (self.cores // workers))

    def text(self) -> str:
        """Return the plan as text: a line for each run, then sums and assumptions."""
        # Several qualities where the scenario draws them at random; a dict keeps their order.
        samples_of: dict[str, dict[str, None]] = {}
        for run in self._all:
            samples_of.setdefault(run.quality, {})[_samples(run.sampling)] = None
        qualities = [f"{quality}, {_joined(samples)}" for quality, samples in samples_of.items()]
        lights = dict.fromkeys(LightPathsRecord.model_validate(run.sampling.paths).text for run in self._all)
        to_line = "start to line" if any(run.start_to_line for run in self.runs) else ""
        lines = [f"{'run':20} {'seconds':>8} {'rows':>7} {'images':>7}  {'size [px]':11}  {to_line}".rstrip()]
        for run in self._all:
            size = f"{run.width_px} x {run.height_px}" if run.images else "-"
            numbers = f"{run.run:20} {run.duration_s:8.1f} {run.rows:7} {run.images:7}"
            lines.append(f"{numbers}  {size:11}  {run.start_to_line}".rstrip())
        rendering = [
            f"quality    {' or '.join(qualities)}",
            f"light      {' or '.join(lights)}",
        ]
        data_mb = self.dataset_bytes / 1e6
        lines += [
            "",
            f"runs       {len(self.runs)}",
            f"images     {self.images}",
            *(rendering if self.images else []),
            *([f"robots     {self.robots}"] if self.robots else []),
            *(f"beyond     {line}" for line in self.demands),
            *(f"WARNING    {line}" for line in self.warnings),
            f"disk       about {self.bytes_needed / 1e6:.0f} MB: {data_mb:.0f} MB of data, the rest in .stages",
            f"simulate   about {seconds(self.simulation_s)}",
            *([f"render     about {self._render_times()}"] if self.images else []),
        ]
        by_workers = f"{plural(self.workers, 'worker')} on " if self.workers else ""
        assumed = (
            f"Assumed: {by_workers}{self.cores} cores without a graphics card; {REAL_TIME_FACTOR:g} simulated seconds"
            f" per second and core{self._tracing() if self.images else ''}"
            + (f"; a lap of {LAP_S:g} s, which depends on arena and robot." if self.runs[0].lap else ".")
        )
        return "\n".join([*lines, "", *wrap(assumed, WIDTH)])

    def _render_times(self) -> str:
        """Return the time to render as text, with that of full rendering where a run may choose hybrid rendering."""
        full_s = self.render_s + self._on_all_cores(sum(run.full_core_s - run.render_core_s for run in self._all))
        without = f", or {seconds(full_s)} if hybrid rendering is too inexact" if full_s > self.render_s else ""
        return f"{seconds(self.render_s)}{without}"

    def _tracing(self) -> str:
        """Return the assumptions about images, their rays and the denoiser."""
        costs = []
        if any(_is_hybrid(run.sampling) for run in self._all):
            costs.append(
                f"{HYBRID_FRAME_S:g} s and {1e6 * HYBRID_PIXEL_S:g} us per pixel for an image from hybrid rendering, "
            )
        probed = [run.sampling for run in self._all if run.sampling.probe]
        if any(_is_hybrid(each) for each in probed):
            costs.append("or else ")
        if probed:
            samples = sorted({each.samples for each in probed})
            costs.append(f"{' or '.join(map(str, samples))} samples per pixel where a run chooses, ")
        if probed:
            counts = " or ".join(map(str, sorted({_probed_samples(each) for each in probed})))
            costs.append(f"{counts} samples per pixel in each image that a run measures, ")
        full = [run.sampling for run in self._all if run.sampling.probe or not _is_hybrid(run.sampling)]
        if full:
            prefilters = {_PREFILTER if each.probe else each.prefilter for each in full if each.denoise}
            times_us = [f"{1e6 * cost_s:g}" for cost_s in sorted(DENOISE_S[name] for name in prefilters)]
            denoising = f"{' or '.join(times_us)} us per pixel to denoise, and " if times_us else "and "
            samples_us = [f"{1e6 * cost_s:.3g}" for cost_s in sorted({_sample_s(each) for each in full})]
            costs.append(f"{' or '.join(samples_us)} us per pixel and sample, {denoising}")
        image = f"{RENDER_FRAME_S:g} s per image on one core; {BYTES_PER_PIXEL:g} bytes per pixel{self._further()}"
        return f"; {''.join(costs)}{image}"

    def _further(self) -> str:
        """Return the assumptions about lenses and annotations, if there are any."""
        widest = max(run.margin for run in self._all)
        lens = f"; {widest:.2f} times as many traced pixels, for the margin that the lens needs" if widest > 1 else ""
        if not any(run.annotated for run in self._all):
            return lens
        times = f"{1e6 * ANNOTATION_PIXEL_S:g} us per pixel and {RENDER_FRAME_S:g} s per image on one core"
        return f"{lens}; all annotations {times}, and {ANNOTATION_BYTES_PER_PIXEL:g} bytes per pixel"


def pixel_s(sampled: TracingSettings) -> float:
    """Return the time [s] on one core for a traced pixel, denoising included."""
    if _is_hybrid(sampled):
        return HYBRID_PIXEL_S
    denoise_s = DENOISE_S[_PREFILTER if sampled.probe else sampled.prefilter] if sampled.denoise else 0.0
    return sampled.samples * _sample_s(sampled) + denoise_s


def _sample_s(sampled: TracingSettings) -> float:
    """Return the time [s] on one core for a sample of a pixel."""
    return RENDER_SAMPLE_S * (CAUSTICS_TIMES if sampled.paths.caustics else 1.0)


def _probed_samples(sampled: TracingSettings) -> int:
    return HYBRID_PROBED_SAMPLES if _is_hybrid(sampled) else PROBED_SAMPLES


def _is_hybrid(sampled: TracingSettings) -> bool:
    """Return whether a run uses hybrid rendering, or has it as the first candidate of its choice."""
    return sampled.hybrid is not None


def _joined(samples: Iterable[str]) -> str:
    """Return numbers of samples with the word "or" between them, and their unit once if it is that of all."""
    texts = list(samples)
    unit = PER_PIXEL if all(text.endswith(PER_PIXEL) for text in texts) else ""
    return " or ".join(text.removesuffix(unit) for text in texts) + unit


def _samples(sampled: TracingSettings) -> str:
    if sampled.probe:
        or_hybrid = "hybrid rendering or " if sampled.hybrid else ""
        return f"{or_hybrid}{LADDER[0].samples} to {LADDER[-1].samples} samples per pixel, as each run needs"
    if sampled.hybrid:
        counts = sampled.hybrid
        return (
            f"from hybrid rendering, {counts.near} and {counts.far} samples of light and {counts.surfaces} of surfaces"
        )
    return f"{plural(sampled.samples, 'sample')} per pixel"


def _planned(spec: RunSpec, camera: RunCamera) -> PlannedRun:
    render = camera.spec.render
    duration_s = min(LAP_S, spec.stop.time_limit_s) if spec.stop.lap else spec.stop.time_limit_s
    image_hz = 1 / camera.period_s if camera.period_s else spec.rates.camera_hz
    images = int(duration_s * image_hz + 1e-9) + 1 if image_hz else 0
    sampled = tracing_settings(rendering_of(render, camera.spec.robot.camera), spec.seed, images=images)
    return PlannedRun(
        run=f"{spec.key} {camera.name}".rstrip(),
        duration_s=duration_s,
        lap=spec.stop.lap,
        rows=int(duration_s * spec.rates.control_hz) + 1,
        images=images,
        width_px=render.width_px,
        height_px=render.height_px,
        annotated=bool(render.annotations),
        quality=render.quality,
        sampling=sampled,
        margin=_traced(camera) / (render.width_px * render.height_px),
        render_core_s=render_core_s(camera, images),
        full_core_s=render_core_s(camera, images, may_be_hybrid=False),
        start_to_line="" if camera.name else start_to_line(spec),
    )


def render_core_s(camera: RunCamera, images: int, *, may_be_hybrid: bool = True) -> float:
    """Return the time [s] of one core for a number of images of a camera in one run, annotations included.

    Args:
        camera: Camera of the run.
        images: Number of its images.
        may_be_hybrid: Whether a run that chooses its rendering is assumed to choose hybrid rendering if it can.
    """
    if not images:
        return 0.0
    render, traced = camera.spec.render, _traced(camera)
    sampled = tracing_settings(rendering_of(render, camera.spec.robot.camera), camera.spec.seed, images=images)
    if sampled.probe and not may_be_hybrid:
        sampled = replace(sampled, hybrid=None)
    image_s = (HYBRID_FRAME_S if _is_hybrid(sampled) else 0.0) + RENDER_FRAME_S + traced * pixel_s(sampled)
    measured = len(probed_numbers(images)) if sampled.probe else 0
    choice_s = measured * traced * _probed_samples(sampled) * _sample_s(sampled)
    annotation_s = RENDER_START_S + images * (RENDER_FRAME_S + traced * ANNOTATION_PIXEL_S)
    return RENDER_START_S + choice_s + images * image_s + (annotation_s if render.annotations else 0.0)


def _traced(camera: RunCamera) -> int:
    """Return the number of pixels that are traced for an image, with the margin that the lens needs."""
    render = camera.spec.render
    pinhole = pinhole_image(intrinsics(camera.spec.robot.camera, render.width_px, render.height_px)).camera
    return pinhole.width_px * pinhole.height_px
