"""The child of `RenderProcess` for this project's renderer, for a plain loop, and for the passes of the reference.

    python cycles_process.py JOB SETTINGS FOLDER THREADS

Settings: {"kind": "ours", "sampling": fields of `TracingSettings`, "hybrid": fields of `HybridSamples` or null},
{"kind": "plain", "cycles": properties of Cycles, "each_of": several numbers of samples, if any}, {"kind": "passes",
"samples": N, "seed": N}, {"kind": "references", "samples": N, "seeds": [N, N]}, {"kind": "chosen", "run_images": N},
which leaves the settings to the measurement of a run of so many images, or {"kind": "choice", "run_images": N}, which
only measures, on a graphics card.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.render.contenders.child_side import ProcessArguments, RenderFrames, reply_stream, serve
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.probe import PROBE, Candidate, ImageErrors, decide, to_json
from blender_scenes.render.sampling import HybridSamples
from sensors.camera.metering import median_luminance
from sensors.camera.response import develop, encode_jpeg
from sensors.camera.views import FrameView
from symolo.core.files.atomic_files import write_file
from symolo.core.files.exr import read_exr

if TYPE_CHECKING:
    from blender_scenes.blender_side.measured_images import Probe

PASSES = ("Combined", "DiffCol", "DiffDir", "DiffInd", "Normal")
_METERED = 1.0
"""Any luminance will do to time what follows the light."""


def main() -> None:
    replies = reply_stream()
    request = ProcessArguments.from_arguments(sys.argv[1:])
    load_bpy(request.threads)
    from blender_scenes.blender_side import build, engine  # noqa: PLC0415 - they import bpy

    kind = request.settings["kind"]
    parts = request.settings.get("hybrid")
    sampling_fields = {**request.settings.get("sampling", {}), "hybrid": HybridSamples(**parts) if parts else None}
    if kind not in {"chosen", "choice"}:
        sampling = replace(request.job.sampling, **sampling_fields)
        request = replace(request, job=replace(request.job, sampling=sampling))
    build.start()
    build.build(request.job.scene, request.job.camera, caustics=request.job.sampling.paths.caustics)
    engine.configure(request.job, request.threads, request.folder)
    serve(replies, request.folder, _KINDS[kind](request))


def _ours(request: ProcessArguments) -> RenderFrames:
    from blender_scenes.blender_side import engine  # noqa: PLC0415 - it imports bpy

    images = engine.FrameTracer(request.job, request.threads, request.folder)
    return _encoded(request, lambda view, _warm_up: images.light(view))


def _chosen(request: ProcessArguments) -> RenderFrames:
    """Return a function that renders as a long run does; its decision lies in the folder of the images."""
    probe = _decided(request, lambda _device: None)
    return _encoded(request, lambda view, _warm_up: probe.tracer.light(view))


def _choice(request: ProcessArguments) -> RenderFrames:
    """Choose as a long run does, with full rendering on a graphics card, and render nothing.

    Hybrid rendering is measured on the processor. The decision lies in the folder of the images.
    """
    import bpy  # noqa: PLC0415 - as above

    def use(device: str) -> None:
        bpy.context.scene.cycles.device = device

    _decided(request, use)
    return lambda _numbers, _warm_up: {}


def _decided(request: ProcessArguments, use: Callable[[str], None]) -> "Probe":
    """Return the images on which the settings of a run of `run_images` were chosen; `use` sets the device."""
    from blender_scenes.blender_side.engine import metered_light  # noqa: PLC0415 - it imports bpy
    from blender_scenes.blender_side.measured_images import Probe  # noqa: PLC0415 - as above

    job = request.job
    probe = Probe(job, request.threads, request.folder, median_luminance(metered_light(job)), lambda: None)

    def measure(candidate: Candidate, samples: int) -> ImageErrors:
        use("GPU")
        probe.refine(samples)
        use("CPU" if isinstance(candidate, HybridSamples) else "GPU")
        return probe.measure(candidate, samples)

    decision = decide("", job.sampling.hybrid, request.settings["run_images"], measure)
    write_file(request.folder / PROBE, to_json(decision))
    return probe


def _plain(request: ProcessArguments) -> RenderFrames:
    """Return a function that only lets Cycles render, with the light paths of the job.

    Given several numbers of samples, an image has a first axis for them.
    """
    import bpy  # noqa: PLC0415 - as above

    from blender_scenes.blender_side import engine  # noqa: PLC0415 - as above

    engine.FrameTracer(request.job, request.threads, request.folder)  # sets the limit on the light of a path
    cycles = bpy.context.scene.cycles
    for name, value in request.settings["cycles"].items():
        setattr(cycles, name, value)
    each_of = request.settings.get("each_of")
    samples = cycles.samples

    def light(view: FrameView, count: int) -> np.ndarray:
        cycles.seed, cycles.samples = view.number, count
        return _rgb(_rendered(view, request)) * np.array(view.light_gain, np.float32)

    if each_of:
        views = {view.number: view for view in request.job.frames}
        return lambda numbers, _warm_up: {n: np.stack([light(views[n], each) for each in each_of]) for n in numbers}
    return _encoded(request, lambda view, warm_up: light(view, 1 if warm_up else samples))


def _encoded(request: ProcessArguments, light: Callable[[FrameView, bool], np.ndarray]) -> RenderFrames:
    """Return a function that also develops and encodes each image, as a run does."""
    views, response = {view.number: view for view in request.job.frames}, request.job.response

    def render(numbers: Sequence[int], warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a RenderFrames
        seen = {}
        for number in numbers:
            seen[number] = light(views[number], warm_up)
            encode_jpeg(develop(seen[number], response, _METERED, number), response.jpeg_quality)
        return seen

    return render


def _passes(request: ProcessArguments) -> RenderFrames:
    """Return a function that renders `PASSES` (5, H, W, 3) without a denoiser."""
    import bpy  # noqa: PLC0415 - as above

    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.cycles.use_denoising = False
    scene.cycles.samples, scene.cycles.seed = request.settings["samples"], request.settings["seed"]
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    for name in ("diffuse_color", "diffuse_direct", "diffuse_indirect", "normal"):
        setattr(layer, f"use_pass_{name}", True)
    views = {view.number: view for view in request.job.frames}

    def render(numbers: Sequence[int], _warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a RenderFrames
        return {number: _split(_rendered(views[number], request)) for number in numbers}

    return render


def _references(request: ProcessArguments) -> RenderFrames:
    """Return a function that renders two images (2, H, W, 3) without a denoiser, with different random numbers."""
    from blender_scenes.blender_side import engine  # noqa: PLC0415 - it imports bpy

    samples, seeds = request.settings["samples"], request.settings["seeds"]
    size = engine.FrameTracer(request.job, request.threads, request.folder).size
    views = {view.number: view for view in request.job.frames}

    def light(view: FrameView, seed: int) -> np.ndarray:
        traced = engine.reference_light(view, size, seed=seed, samples=samples)
        return traced * np.array(view.light_gain, np.float32)

    def render(numbers: Sequence[int], _warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a RenderFrames
        return {number: np.stack([light(views[number], seed) for seed in seeds]) for number in numbers}

    return render


_KINDS = {
    "ours": _ours,
    "chosen": _chosen,
    "choice": _choice,
    "plain": _plain,
    "passes": _passes,
    "references": _references,
}


def _split(channels: dict[str, np.ndarray]) -> np.ndarray:
    by_pass: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        *_, pass_name, component = name.split(".")
        by_pass.setdefault(pass_name, {})[component] = values
    letters = {name: "XYZ" if name == "Normal" else "RGB" for name in PASSES}
    return np.stack([np.stack([by_pass[name][c] for c in letters[name]], axis=-1) for name in PASSES]).astype(
        np.float32
    )


def _rendered(view: FrameView, request: ProcessArguments) -> dict[str, Any]:
    import bpy  # noqa: PLC0415 - as above

    from blender_scenes.blender_side.placing import place  # noqa: PLC0415 - as above

    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = request.job.camera.width_px, request.job.camera.height_px
    place(view)
    bpy.ops.render.render(write_still=True)
    return read_exr(Path(render.filepath).read_bytes())


def _rgb(channels: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float32)


if __name__ == "__main__":
    main()
