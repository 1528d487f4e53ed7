"""Annotations from one ray through the middle of each pixel."""

import time
from collections.abc import Iterator
from pathlib import Path

import bpy

from blender_scenes.annotations.images import IMAGE_ANNOTATIONS, encode_png
from blender_scenes.annotations.job import AnnotationJob, record_file
from blender_scenes.annotations.record import record
from blender_scenes.annotations.visible_scene import Passes, VisibleScene
from blender_scenes.blender_side import build, engine
from blender_scenes.blender_side.shaders import ShaderGraph
from blender_scenes.render.frame_files import FrameFile, put_data_in_place, put_in_place
from sensors.camera.lens_warp import pinhole_image
from sensors.camera.views import FrameView
from symolo.dataset.annotations import annotation_file

_EXR_PIXEL_BYTES = 44
"""Colour with opacity, index, position and normal, four bytes for each component."""


def start(job: AnnotationJob, threads: int, scratch: Path) -> None:
    """Build the job's geometry and set Blender's passes for annotations, without light."""
    build.start()
    build.build(job.scene, job.camera)
    engine.configure(job, threads, scratch)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    layer.use_pass_object_index = layer.use_pass_position = layer.use_pass_normal = True
    layer.use_pass_z = False
    layer.material_override = _black()


def _black() -> bpy.types.Material:
    """Return a surface that neither emits nor scatters light, which takes half the time of one that does."""
    made = bpy.data.materials.new("black")
    made.use_nodes = True
    graph = ShaderGraph(made.node_tree)
    shader = graph.node("ShaderNodeEmission", Strength=0.0)
    graph.node("ShaderNodeOutputMaterial", Surface=shader.outputs[0])
    return made


def annotate(job: AnnotationJob, view: FrameView, folder: Path) -> Iterator[FrameFile]:
    """Put the files of a frame in place below `folder`."""
    begin = time.perf_counter()
    size = job.camera.width_px, job.camera.height_px
    sampling = job.sampling
    pinhole = pinhole_image(job.camera).camera
    channels = engine.traced(
        view,
        (pinhole.width_px, pinhole.height_px),
        _EXR_PIXEL_BYTES,
        seed=sampling.seed,
        samples=sampling.samples,
        denoise=sampling.denoise,
    )
    passes = Passes.from_channels(channels, bpy.context.view_layer.name).through_lens(job.camera)
    seen = VisibleScene(job, view, job.following(view.number), passes)
    names = job.files(view.number)
    for kind, make_image in IMAGE_ANNOTATIONS.items():
        name = annotation_file(kind, view.number)
        image = make_image(seen) if name in names else None
        if image is not None:
            data = encode_png(image)
            yield _done(view, name, put_in_place(data, folder / name, *size), data, begin)
            begin = time.perf_counter()
    if (name := record_file(view.number)) in names:
        data = record(seen).to_json()
        yield _done(view, name, put_data_in_place(data, folder / name), data, begin)


def _done(view: FrameView, name: str, sha256: str, data: bytes, begin: float) -> FrameFile:
    return FrameFile(view.number, name, sha256, len(data), time.perf_counter() - begin)
