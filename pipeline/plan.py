"""What a scenario would make, how large it would be and how long it would take; estimates, with what they rest on."""

from collections.abc import Sequence
from dataclasses import dataclass

from configs.schema.scenario import RunSpec
from pipeline.progress import seconds

LAP_S = 40.0
"""Simulated seconds of a lap of the shipped arena; others differ."""
REAL_TIME_FACTOR = 10.0
"""Simulated seconds per second and core, the least that the project promises."""
RENDER_START_S = 4.0
"""Start of Blender and making of the scene, per run."""
RENDER_FRAME_S = 0.05
"""Per image whatever its size, on one core."""
RENDER_SAMPLE_S = 8.5e-6
"""Per pixel and sample on one core."""
BYTES_PER_PIXEL = 0.2
"""Of a JPEG of quality 92."""
ANNOTATION_PIXEL_S = 1.5e-6
"""Per pixel on one core, all annotations together."""
ANNOTATION_BYTES_PER_PIXEL = 0.6
"""Likewise; the flow alone takes nine tenths of it."""
BYTES_PER_IMAGE = 4096
"""Besides its pixels: tables, and the rest of a disk block."""
BYTES_PER_ROW = 600
"""data.csv, side files and the stored trajectory."""
COPIES = 2
"""The stages keep what the release holds, so that a rerun continues."""


@dataclass(frozen=True)
class PlannedRun:
    run: str
    duration_s: float
    lap: bool
    rows: int
    images: int
    width_px: int
    height_px: int
    annotated: bool
    render_core_s: float


@dataclass(frozen=True)
class Plan:
    runs: tuple[PlannedRun, ...]
    cores: int

    @classmethod
    def of(cls, specs: Sequence[RunSpec], cores: int) -> "Plan":
        return cls(tuple(_planned(spec) for spec in specs), cores)

    @property
    def images(self) -> int:
        return sum(run.images for run in self.runs)

    @property
    def bytes_needed(self) -> int:
        """Disk space with some to spare [byte]."""
        per_pixel = {False: BYTES_PER_PIXEL, True: BYTES_PER_PIXEL + ANNOTATION_BYTES_PER_PIXEL}
        pixels = sum(run.images * run.width_px * run.height_px * per_pixel[run.annotated] for run in self.runs)
        pictures = pixels + self.images * BYTES_PER_IMAGE
        rows = sum(run.rows for run in self.runs) * BYTES_PER_ROW
        return round(COPIES * (pictures + rows) + 1e6)

    @property
    def simulation_s(self) -> float:
        return sum(run.duration_s for run in self.runs) / REAL_TIME_FACTOR / min(self.cores, len(self.runs))

    @property
    def render_s(self) -> float:
        return sum(run.render_core_s for run in self.runs) / self.cores

    def text(self) -> str:
        """The plan for a person, one line a run, then sums and assumptions."""
        lines = [f"{'run':20} {'seconds':>8} {'rows':>7} {'images':>7}  size [px]"]
        lines += [
            f"{run.run:20} {run.duration_s:8.1f} {run.rows:7} {run.images:7}  {run.width_px} x {run.height_px}"
            for run in self.runs
        ]
        lines += [
            "",
            f"runs       {len(self.runs)}",
            f"images     {self.images}",
            f"disk       about {self.bytes_needed / 1e6:.0f} MB, stages included",
            f"simulate   about {seconds(self.simulation_s)}",
            f"render     about {seconds(self.render_s)}",
            "",
            f"Assumed: {self.cores} cores without a graphics card; {REAL_TIME_FACTOR:g} simulated seconds a second and"
            f" core; {1e6 * RENDER_SAMPLE_S:g} us a pixel and sample and {RENDER_FRAME_S:g} s an image on one core;"
            f" {BYTES_PER_PIXEL:g} bytes a pixel"
            + (f"; a lap of {LAP_S:g} s, which depends on arena and robot." if self.runs[0].lap else "."),
        ]
        return "\n".join(lines)


def _planned(spec: RunSpec) -> PlannedRun:
    duration_s = min(LAP_S, spec.stop.time_limit_s) if spec.stop.lap else spec.stop.time_limit_s
    images = int(duration_s * spec.rates.camera_hz) + 1
    render = spec.render
    pixels, annotated = render.width_px * render.height_px, bool(render.annotations)
    image_s = RENDER_FRAME_S + pixels * render.samples * RENDER_SAMPLE_S
    annotation_s = RENDER_START_S + images * (RENDER_FRAME_S + pixels * ANNOTATION_PIXEL_S) if annotated else 0.0
    return PlannedRun(
        run=spec.key,
        duration_s=duration_s,
        lap=spec.stop.lap,
        rows=int(duration_s * spec.rates.control_hz) + 1,
        images=images,
        width_px=render.width_px,
        height_px=render.height_px,
        annotated=annotated,
        render_core_s=RENDER_START_S + images * image_s + annotation_s,
    )
