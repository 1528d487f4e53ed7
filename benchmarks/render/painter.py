"""The process behind `painters.Painter` for this project's renderer, for a plain loop, and for the reference's passes.

    python painter.py JOB SETTINGS FOLDER THREADS

Settings: {"kind": "ours", "sampling": fields of `TracingSettings`, "hybrid": fields of `HybridSamples` or null},
{"kind": "plain", "cycles": properties of Cycles}, or {"kind": "passes", "samples": N, "seed": N}.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from painter_side import Asked, Paint, own_replies, serve

from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.sampling import HybridSamples
from sensors.camera.response import develop, encode_jpeg
from sensors.camera.views import FrameView
from symolo.core.files.exr import read_exr

PASSES = ("Combined", "DiffCol", "DiffDir", "DiffInd", "Normal")
_METERED = 1.0
"""Any luminance will do to time what follows the light."""


def main() -> None:
    replies = own_replies()
    asked = Asked.from_arguments(sys.argv[1:])
    load_bpy(asked.threads)
    from blender_scenes.blender_side import build, engine  # noqa: PLC0415 - they import bpy

    kind = asked.settings["kind"]
    parts = asked.settings.get("hybrid")
    own = {**asked.settings.get("sampling", {}), "hybrid": HybridSamples(**parts) if parts else None}
    sampling = replace(asked.job.sampling, **own)
    asked = replace(asked, job=replace(asked.job, sampling=sampling))
    build.start()
    build.build(asked.job.scene, asked.job.camera)
    engine.configure(asked.job, asked.threads, asked.folder)
    serve(replies, asked.folder, _KINDS[kind](asked))


def _ours(asked: Asked) -> Paint:
    from blender_scenes.blender_side import engine  # noqa: PLC0415 - it imports bpy

    pictures = engine.FrameTracer(asked.job, asked.threads, asked.folder)
    return _painted(asked, lambda view, _warm_up: pictures.light(view))


def _plain(asked: Asked) -> Paint:
    """Cycles told to render, and nothing else."""
    import bpy  # noqa: PLC0415 - as above

    cycles = bpy.context.scene.cycles
    for name, value in asked.settings["cycles"].items():
        setattr(cycles, name, value)
    samples = cycles.samples

    def light(view: FrameView, warm_up: bool) -> np.ndarray:  # noqa: FBT001 - as a Paint
        cycles.seed, cycles.samples = view.number, 1 if warm_up else samples
        return _rgb(_rendered(view, asked)) * np.array(view.light_gain, np.float32)

    return _painted(asked, light)


def _painted(asked: Asked, light: Callable[[FrameView, bool], np.ndarray]) -> Paint:
    """Develops and encodes each picture too, as a run does."""
    views = {view.number: view for view in asked.job.frames}

    def paint(numbers: Sequence[int], warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a Paint
        seen = {}
        for number in numbers:
            seen[number] = light(views[number], warm_up)
            encode_jpeg(develop(seen[number], asked.job.response, _METERED, number), asked.job.response.jpeg_quality)
        return seen

    return paint


def _passes(asked: Asked) -> Paint:
    """(5, H, W, 3): `PASSES`, traced without a denoiser."""
    import bpy  # noqa: PLC0415 - as above

    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.cycles.use_denoising = False
    scene.cycles.samples, scene.cycles.seed = asked.settings["samples"], asked.settings["seed"]
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    for name in ("diffuse_color", "diffuse_direct", "diffuse_indirect", "normal"):
        setattr(layer, f"use_pass_{name}", True)
    views = {view.number: view for view in asked.job.frames}

    def paint(numbers: Sequence[int], _warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a Paint
        return {number: _split(_rendered(views[number], asked)) for number in numbers}

    return paint


_KINDS = {"ours": _ours, "plain": _plain, "passes": _passes}


def _split(channels: dict[str, np.ndarray]) -> np.ndarray:
    found: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        *_, of, component = name.split(".")
        found.setdefault(of, {})[component] = values
    letters = {name: "XYZ" if name == "Normal" else "RGB" for name in PASSES}
    return np.stack([np.stack([found[name][c] for c in letters[name]], axis=-1) for name in PASSES]).astype(np.float32)


def _rendered(view: FrameView, asked: Asked) -> dict[str, Any]:
    import bpy  # noqa: PLC0415 - as above

    from blender_scenes.blender_side.placing import place  # noqa: PLC0415 - as above

    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = asked.job.camera.width_px, asked.job.camera.height_px
    place(view)
    bpy.ops.render.render(write_still=True)
    return read_exr(Path(render.filepath).read_bytes())


def _rgb(channels: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float32)


if __name__ == "__main__":
    main()
