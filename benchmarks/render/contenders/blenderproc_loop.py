"""The child of `RenderProcess` for BlenderProc: its own initialisation and render loop, on our scene.

    python blenderproc_loop.py JOB SETTINGS FOLDER THREADS

Runs in an environment of its own, outside of this project's, made by `python3.11 -m venv DIR` and

    DIR/bin/python -m pip install blenderproc "bpy==4.5.*" "numpy<2" pydantic PyYAML opencv-python-headless \\
        scipy rich trimesh imageio gitpython scikit-image scikit-learn pypng

`blenderproc run` starts a Blender that it downloads; release 2.8.0 takes no bpy module instead. All that comes after is
the same, so its package is entered past its `__init__`, which asks for that start, and `init` is followed step by step
but for the language, of which a bpy module has one. Changed are: CPU alone, as for the others; images in OpenEXR, so
that all contenders' light goes through one camera.
Settings: {"light_paths": "defaults"}, or {"light_paths": "ours"} to set bounces and caustics as ours are, without a
clamp.
"""

import importlib.util
import sys
import types
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.render.contenders.child_side import ProcessArguments, RenderFrames, reply_stream, serve
from symolo.core.files.exr import read_exr
from symolo.core.geometry.poses import pose_X_WR

_PREFIX = "rgb_"
_LIGHT_PATHS = ("caustics_reflective", "caustics_refractive", "sample_clamp_indirect")


def main() -> None:
    replies = reply_stream()
    request = ProcessArguments.from_arguments(sys.argv[1:])
    import bpy  # noqa: F401, PLC0415 - loaded before what stands on it

    _enter()
    _set_up(request)
    serve(replies, request.folder, _loop(request))


def _enter() -> None:
    spec = importlib.util.find_spec("blenderproc")
    if spec is None or spec.submodule_search_locations is None:
        raise SystemExit("BlenderProc is missing; install it as the head of this file says")
    package = types.ModuleType("blenderproc")
    package.__path__ = list(spec.submodule_search_locations)
    sys.modules["blenderproc"] = package


def _set_up(request: ProcessArguments) -> None:
    import bpy  # noqa: PLC0415 - after reply_stream
    from blenderproc.python.renderer import RendererUtility  # noqa: PLC0415 - after _enter
    from blenderproc.python.utility.Initializer import _Initializer, clean_up  # noqa: PLC0415 - as above

    from blender_scenes.blender_side import build  # noqa: PLC0415 - it imports bpy

    clean_up(clean_up_camera=True)
    bpy.context.scene.render.engine = "CYCLES"
    RendererUtility.set_render_devices(use_only_cpu=True)
    _Initializer.set_default_parameters()
    build.build(request.job.scene, request.job.camera, caustics=request.job.sampling.paths.caustics)
    camera, render = request.job.camera, bpy.context.scene.render
    render.resolution_x, render.resolution_y = camera.width_px, camera.height_px
    RendererUtility.set_output_format(file_format="OPEN_EXR", color_depth=32)
    render.image_settings.exr_codec = "NONE"
    if request.settings["light_paths"] == "ours":
        ours = request.job.sampling.paths
        bounces = ours.diffuse_bounces, ours.glossy_bounces, 0, ours.max_bounces, ours.transmission_bounces
        RendererUtility.set_light_bounces(*bounces, 8, 0)
        for name, value in zip(_LIGHT_PATHS, (ours.caustics, ours.caustics, 0.0), strict=True):
            setattr(bpy.context.scene.cycles, name, value)


def _loop(request: ProcessArguments) -> RenderFrames:
    import bpy  # noqa: PLC0415 - as above
    from blenderproc.python.camera import CameraUtility  # noqa: PLC0415 - as above
    from blenderproc.python.renderer import RendererUtility  # noqa: PLC0415 - as above
    from blenderproc.python.utility.Utility import reset_keyframes  # noqa: PLC0415 - as above
    from mathutils import Matrix  # noqa: PLC0415 - as above

    from blender_scenes.blender_side.build import ROBOT  # noqa: PLC0415 - as above

    views = {view.number: view for view in request.job.frames}
    samples = bpy.context.scene.cycles.samples

    def render(numbers: Sequence[int], warm_up: bool) -> dict[int, np.ndarray]:  # noqa: FBT001 - a RenderFrames
        reset_keyframes()
        RendererUtility.set_max_amount_of_samples(1 if warm_up else samples)
        for frame, number in enumerate(numbers):
            view = views[number]
            X_WC = np.array(view.X_WC) @ np.diag([1.0, -1.0, -1.0, 1.0])  # Blender's camera looks along its -z
            CameraUtility.add_camera_pose(X_WC, frame)
            robot = bpy.data.objects[ROBOT]
            robot.matrix_world = Matrix(pose_X_WR(*view.robot_pose).tolist())
            for channel in ("location", "rotation_euler"):
                robot.keyframe_insert(channel, frame=frame)
        RendererUtility.render(output_dir=str(request.folder), file_prefix=_PREFIX, output_key=None, return_data=False)
        return {number: _light(request.folder, i, views[number].light_gain) for i, number in enumerate(numbers)}

    return render


def _light(folder: Path, frame: int, gain: Sequence[float]) -> np.ndarray:
    channels = read_exr((folder / f"{_PREFIX}{frame:04d}.exr").read_bytes())
    return np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float32) * np.array(gain, np.float32)


if __name__ == "__main__":
    main()
