"""Cycles: all settings on which a pixel depends, and the linear light of a view."""

from pathlib import Path

import bpy
import numpy as np

from blender_scenes.blender_side import gpus
from blender_scenes.blender_side.hybrid.images import HybridRenderer
from blender_scenes.blender_side.matt_colors import measure_matt_colors
from blender_scenes.blender_side.placing import open_shutter, place
from blender_scenes.blender_side.rendering import rendered
from blender_scenes.render.job import RenderJob
from blender_scenes.render.lost_light import lost_light_factor
from sensors.camera.colour import as_measured
from sensors.camera.lens_warp import field_of_view, pinhole_image, through_lens
from sensors.camera.metering import median_luminance, metered_views, metering_camera
from sensors.camera.response import white_level
from sensors.camera.rolling_shutter import rolling_shutter_shift
from sensors.camera.shutter import window
from sensors.camera.views import FrameView
from symolo.core.random_streams import stream

_SCRATCH = "light.exr"
_METERING_SAMPLES = 8
_EXR_PIXEL_BYTES, _PASSES_PIXEL_BYTES = 12, 60
"""Size of a pixel of an image of the light, and of one with the passes of the denoiser."""


def configure(job: RenderJob, threads: int, scratch: Path) -> None:
    """Set all options of the scene but the image's size, which is set for each view.

    Raises:
        EnvironmentLacking: The job is for a kind of graphics card that the machine does not have.
    """
    if job.sampling.device != "CPU":
        gpus.enable(job.sampling.device)
    scene = bpy.context.scene
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    render.threads_mode, render.threads = "FIXED", threads
    render.use_persistent_data = True
    render.use_border = render.use_compositing = render.use_sequencer = False
    render.film_transparent = False
    render.dither_intensity = 0.0
    render.filepath = str(scratch / _SCRATCH)
    render.use_file_extension = False
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGB", "32", "NONE"
    image.color_management = "FOLLOW_SCENE"
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform, scene.view_settings.look = "Raw", "None"  # OpenEXR is written linear anyway
    scene.view_settings.exposure, scene.view_settings.gamma = 0.0, 1.0
    _cycles(scene.cycles, job)
    if not job.sampling.paths.caustics:
        measure_matt_colors(job.scene, scratch)
    open_shutter(window(job.shutter, job.camera))


def _cycles(cycles: bpy.types.PropertyGroup, job: RenderJob) -> None:
    sampling, paths = job.sampling, job.sampling.paths
    # Without caustics, all other surfaces are matt for light that they reflect to a matt surface (`shaders`).
    gloss_throws_light = paths.caustics or any(surface.encloses_lamp for surface in job.scene.surfaces)
    settings = {
        "device": "CPU" if sampling.device == "CPU" else "GPU",
        "feature_set": "SUPPORTED",
        "shading_system": False,
        "samples": sampling.samples,
        "use_adaptive_sampling": False,
        "use_sample_subset": False,
        "time_limit": 0.0,
        "sampling_pattern": "TABULATED_SOBOL",
        "scrambling_distance": 1.0,
        "auto_scrambling_distance": False,
        "use_denoising": sampling.denoise,
        "denoiser": "OPENIMAGEDENOISE",
        "denoising_input_passes": "RGB_ALBEDO_NORMAL",
        "denoising_prefilter": sampling.prefilter,
        "denoising_quality": sampling.denoise_quality,
        "denoising_use_gpu": sampling.device != "CPU",
        "use_light_tree": False,
        "light_sampling_threshold": 0.0,
        "use_guiding": False,
        "max_bounces": paths.max_bounces,
        "diffuse_bounces": paths.diffuse_bounces,
        "glossy_bounces": paths.glossy_bounces,
        "transmission_bounces": paths.transmission_bounces,
        "volume_bounces": 0,
        "transparent_max_bounces": 8,
        "min_light_bounces": 0,
        "min_transparent_bounces": 0,
        "caustics_reflective": gloss_throws_light,
        "caustics_refractive": paths.caustics,
        "blur_glossy": 0.0 if gloss_throws_light else 1.0,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,  # `FrameTracer` sets it, from the exposure
        "use_fast_gi": False,
        "film_exposure": 1.0,
        "pixel_filter_type": "BLACKMAN_HARRIS",
        "filter_width": sampling.filter_width_px,
        "use_animated_seed": False,
        "use_auto_tile": False,
        "debug_bvh_type": "DYNAMIC_BVH",
        "debug_use_spatial_splits": False,
    }
    for name, value in settings.items():
        setattr(cycles, name, value)


class FrameTracer:
    """The light of the frames of a configured job."""

    def __init__(self, job: RenderJob, threads: int, scratch: Path, metered: float | None = None) -> None:
        """Meter the exposure and prepare the renderer.

        Args:
            job: Job for which `configure` was called.
            threads: Number of threads.
            scratch: Folder for temporary files.
            metered: Median luminance of the run; None to measure it.

        Raises:
            ValueError: No light reaches what the camera sees.
        """
        self._job = job
        self.metered = median_luminance(metered_light(job)) if metered is None else metered
        """Median luminance of the run, which sets its exposure."""
        limit = job.sampling.paths.clamp * white_level(self.metered, job.response)
        cycles = bpy.context.scene.cycles
        cycles.sample_clamp_indirect = limit
        cycles.denoising_prefilter, cycles.denoising_quality = job.sampling.prefilter, job.sampling.denoise_quality
        camera = pinhole_image(job.camera).camera
        self.size = camera.width_px, camera.height_px
        """Width and height of the pinhole image."""
        self._hybrid = HybridRenderer(job, threads, scratch) if job.sampling.hybrid else None

    def light(self, view: FrameView) -> np.ndarray:
        """Return the linear light (H, W, 3) of one of the job's frames."""
        job = self._job
        light = self.pinhole_light(view)
        return through_lens(light, job.camera, rolling_shutter_shift(view, job.camera, job.shutter))

    def pinhole_light(self, view: FrameView) -> np.ndarray:
        """Return the linear light (H, W, 3) of a view before it passes the lens."""
        job = self._job
        seed = noise_seed(job.sampling.seed, "frame", view.number)
        if self._hybrid is not None:
            light = self._hybrid.light(view, seed)
        else:
            trace = denoised_light if job.sampling.denoise else traced_light
            light = trace(view, self.size, seed=seed, samples=job.sampling.samples)
        return light * np.array(view.light_gain, np.float32)


def metered_light(job: RenderJob) -> np.ndarray:
    """Return the light of small images of a few of the job's views, as the sensor measures it in the field of view."""
    small = metering_camera(pinhole_image(job.camera).camera)
    size, field = (small.width_px, small.height_px), field_of_view(small)
    lights = []
    for view in metered_views(job.frames):
        seed = noise_seed(job.sampling.seed, "metering", view.number)
        light = traced_light(view, size, seed=seed, samples=_METERING_SAMPLES)
        lights.append(light if field is None else light[field])
    return as_measured(np.concatenate(lights), job.response.colour_filter)


def noise_seed(seed: int, *path: str | int) -> int:
    """Return the seed of Cycles for one rendering of a job."""
    return int(stream(seed, "path tracing", *path).integers(2**31))


def traced_light(view: FrameView, size: tuple[int, int], *, seed: int, samples: int) -> np.ndarray:
    """Return the linear light (H, W, 3) of a view with its noise; errors are those of `rendered`."""
    return _rgb(traced(view, size, _EXR_PIXEL_BYTES, seed=seed, samples=samples, denoise=False))


def denoised_light(view: FrameView, size: tuple[int, int], *, seed: int, samples: int) -> np.ndarray:
    """Return the denoised linear light (H, W, 3) of a view, with the mean that it has without the denoiser.

    Errors are those of `rendered`.
    """
    layer, image = bpy.context.view_layer, bpy.context.scene.render.image_settings
    layer.cycles.denoising_store_passes, image.file_format = True, "OPEN_EXR_MULTILAYER"
    try:
        channels = traced(view, size, _PASSES_PIXEL_BYTES, seed=seed, samples=samples, denoise=True)
    finally:
        layer.cycles.denoising_store_passes, image.file_format = False, "OPEN_EXR"
    noisy, denoised = (_rgb(channels, f"{layer.name}.{name}.") for name in ("Noisy Image", "Combined"))
    return denoised * np.float32(lost_light_factor(noisy, denoised))


def _rgb(channels: dict[str, np.ndarray], prefix: str = "") -> np.ndarray:
    return np.stack([channels[prefix + name] for name in "RGB"], axis=-1).astype(np.float32)


def reference_light(view: FrameView, size: tuple[int, int], *, seed: int, samples: int) -> np.ndarray:
    """Return the linear light (H, W, 3) of a view without a denoiser, for comparison with images of other seeds.

    Cycles has one sequence of samples for each seed, whose first sample lies in the middle of the pixel for every seed.
    A reference that had this sample would share with the images what it gets wrong at edges. So a reference has the
    samples from the next power of two on. They are spread evenly over a pixel, as blocks of a Sobol sequence are that
    begin at a multiple of their length.
    """
    cycles = bpy.context.scene.cycles
    first = 1 << (samples - 1).bit_length()
    cycles.use_sample_subset, cycles.sample_offset, cycles.sample_subset_length = True, first, samples
    try:
        return traced_light(view, size, seed=seed, samples=first + samples)
    finally:
        cycles.use_sample_subset = False


def traced(
    view: FrameView, size: tuple[int, int], pixel_bytes: int, *, seed: int, samples: int, denoise: bool
) -> dict[str, np.ndarray]:
    """Return the channels (H, W) of a rendered view by name; for `pixel_bytes` and errors see `rendered`."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.use_border = scene.render.use_crop_to_border = False
    scene.cycles.seed, scene.cycles.samples, scene.cycles.use_denoising = seed, samples, denoise
    place(view)
    return rendered(scene, pixel_bytes)
