"""Fit of a camera: settings with which an image of its model has the same measures as the photographs.

The model image is a line of one level on a floor of another one, developed by `sensors.camera.response` with the size
of the photographs. It needs no rendering. Each setting belongs to one measure and is corrected by the form that the
camera model has: variances of the blur add up, and so do those of shot noise and read noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from configs.schema.appearance.camera_look import CameraLook, ColourFilter
from configs.schema.scenario import Render
from diagnosis.photographs.line_place import BgrImage, LinePlace
from diagnosis.photographs.measures import (
    PhotographMeasures,
    light_of,
    median_light,
    median_of,
    shading_ev,
    vignetting,
)
from sensors.camera.colour import LUMINANCE
from sensors.camera.response import CameraResponse, compressed, develop
from symolo.core.arrays import Array, FloatImage

ROUNDS = 8
"""Number of corrections; after them, the measures of the model image no longer change noticeably."""
_WIDTH_OF_SD = 2.563
"""Distance from 10 to 90 % of an edge that is blurred by a Gaussian, in standard deviations."""
_SHARPENING_OF_OVERSHOOT = 4.0
"""Rise of `sharpening` that raises the overshoot by 1, approximately; the corrections approach the right value."""
_FINER = 8
"""Points per pixel with which the share of the line in a pixel is computed."""
_DARKEST = 1e-5
"""Smallest linear light, so that ratios are defined."""
_NOISELESS = 0.02
"""Standard deviation in grey values below which an image has no noise."""
_MIN_VARIANCE = 1e-8
"""Smallest variance of the noise, so that its inverse is defined."""
_MODEL_IMAGES = 3
"""Number of model images that are measured, each with the line at another place between the pixels."""


@dataclass(frozen=True)
class CameraTarget:
    """Measures that the camera is to have: medians over the photographs."""

    edge_px: float
    overshoot: float
    floor_noise: float
    line_noise: float
    floor_rgb: Array
    """(3,), grey values 0 to 255."""
    line_rgb: Array
    """(3,)."""

    @classmethod
    def from_photographs(cls, photographs: Sequence[PhotographMeasures]) -> "CameraTarget":
        """Return the medians over photographs, at least one."""
        return cls(
            edge_px=median_of(photographs, lambda p: p.edge_px),
            overshoot=median_of(photographs, lambda p: p.overshoot),
            floor_noise=median_of(photographs, lambda p: p.floor_noise),
            line_noise=median_of(photographs, lambda p: p.line_noise),
            floor_rgb=np.median([p.floor_rgb for p in photographs], axis=0),
            line_rgb=np.median([p.line_rgb for p in photographs], axis=0),
        )


@dataclass(frozen=True)
class FittedCamera:
    """A camera, with the light of floor and line in its images."""

    look: CameraLook
    floor_light: Array
    """(3,), linear, 1 for white."""
    line_light: Array
    """(3,)."""
    measures: CameraTarget
    """Measures of the model image."""

    @property
    def is_monochrome(self) -> bool:
        return self.look.colour_filter == "monochrome"


def fit_camera(photographs: Sequence[PhotographMeasures], base: CameraLook) -> FittedCamera:
    """Return the camera that `base` becomes with the measures of the photographs, which have one size.

    Args:
        photographs: Photographs of one camera.
        base: Camera with the settings that photographs do not reveal: tone curve, noise reduction, colour filter.
    """
    target = CameraTarget.from_photographs(photographs)
    falloff = vignetting(photographs, base.contrast)
    look = base.model_copy(
        update={
            "vignetting": falloff,
            "brightness": _within(median_of(photographs, lambda p: median_light(p, base.contrast, falloff)), 0.01, 0.9),
            "compensation_ev": 0.0,
            "exposure_time_s": 0.0,
            "manual_exposure": None,
            "defocus_share": 0.0,
            "lens_blur_px": _blur_px(target.edge_px**2 / _WIDTH_OF_SD**2 - 1 / 12),
            "shot_noise": max(base.shot_noise, 0.002),
            "read_noise": max(base.read_noise, 0.001),
            "sharpening": 0.0,
            "colour_filter": _colour_filter(photographs, base),
            # The floor has its colour in the photographs if its light is rendered neutral.
            "white_balance_adaption": 1.0,
            "shading_right_ev": _within(
                median_of(photographs, lambda p: shading_ev(p, base.contrast, falloff)[0]), -3, 3
            ),
            "shading_down_ev": _within(
                median_of(photographs, lambda p: shading_ev(p, base.contrast, falloff)[1]), -3, 3
            ),
        }
    )
    geometry = photographs[0].place.shape, median_of(photographs, lambda p: p.place.width_px)
    floor, line = (light_of(rgb, base.contrast) for rgb in (target.floor_rgb, target.line_rgb))
    camera = FittedCamera(look, floor, line, target)
    for _ in range(ROUNDS):
        measured = _measured(camera, *geometry)
        camera = corrected(replace(camera, measures=measured), target)
    return replace(camera, measures=_measured(camera, *geometry))


def _colour_filter(photographs: Sequence[PhotographMeasures], base: CameraLook) -> ColourFilter:
    """Return that of the base; photographs without any colour are those of a monochrome camera, and others are not."""
    if all(np.ptp(photograph.place.image, axis=2).max() == 0 for photograph in photographs):
        return "monochrome"
    return "none" if base.colour_filter == "monochrome" else base.colour_filter


def corrected(camera: FittedCamera, target: CameraTarget) -> FittedCamera:
    """Return the camera with each setting corrected by what its measure lacks."""
    look, measured = camera.look, camera.measures
    sharpening = look.sharpening + _SHARPENING_OF_OVERSHOOT * (target.overshoot - measured.overshoot)
    variance = look.lens_blur_px**2 + (target.edge_px**2 - measured.edge_px**2) / _WIDTH_OF_SD**2
    levels = np.array([camera.floor_light @ LUMINANCE, camera.line_light @ LUMINANCE])
    pairs = ((target.floor_noise, measured.floor_noise), (target.line_noise, measured.line_noise))
    ratios = np.array([max(one, _NOISELESS) / max(other, _NOISELESS) for one, other in pairs])
    # With noise reduction, the noise of an image grows about as the square of that of the sensor. A correction of the
    # variance by the square of the ratio would then never come to rest.
    variances = np.maximum((look.shot_noise**2 * levels + look.read_noise**2) * ratios, _MIN_VARIANCE)
    # Relative errors count, so that the small variance of the line is as exact as that of the floor.
    columns = np.column_stack([levels, np.ones(2)]) / variances[:, None]
    shot, read = np.sqrt(nnls(columns, np.ones(2))[0])
    return replace(
        camera,
        look=look.model_copy(
            update={
                "sharpening": _within(sharpening, 0.0, 3.0),
                "lens_blur_px": _blur_px(variance),
                "shot_noise": _within(shot, 0.0, 0.5),
                "read_noise": _within(read, 0.0, 0.5),
            }
        ),
        floor_light=_light(camera.floor_light, target.floor_rgb, measured.floor_rgb, look),
        line_light=_light(camera.line_light, target.line_rgb, measured.line_rgb, look),
    )


def _light(light: Array, target_rgb: Array, measured_rgb: Array, look: CameraLook) -> Array:
    """Return the light that changes the measured levels into those of the target."""
    target, measured = (np.maximum(light_of(rgb, look.contrast), _DARKEST) for rgb in (target_rgb, measured_rgb))
    return np.maximum(light * target / measured, _DARKEST)


def _measured(camera: FittedCamera, shape: tuple[int, int], width_px: float) -> CameraTarget:
    """Return the measures of the model images."""
    places = [model_image(camera, shape, width_px, number) for number in range(_MODEL_IMAGES)]
    measures = [measured for place in places if (measured := PhotographMeasures.from_place("model", place))]
    if not measures:
        raise ValueError(f"a line {width_px:.0f} px wide leaves no floor in an image {shape[1]} px wide")
    return CameraTarget.from_photographs(measures)


def model_image(camera: FittedCamera, shape: tuple[int, int], width_px: float, number: int = 0) -> LinePlace:
    """Return the image of a slightly slanted line on an even floor, with the place of the line.

    Args:
        camera: Camera and light.
        shape: Height and width of the image [px].
        width_px: Width of the line along a row [px].
        number: Number of the image; others have other noise, and the line between other pixels.
    """
    height, width = shape
    rows = np.arange(height, dtype=float)
    middle = 0.5 * (width - 1) + number / _MODEL_IMAGES + 0.07 * (rows - 0.5 * height)
    x = (np.arange(width * _FINER) + 0.5) / _FINER - 0.5
    covered = (np.abs(x[None, :] - middle[:, None]) < 0.5 * width_px).reshape(height, width, _FINER).mean(axis=2)
    light = camera.floor_light + covered[..., None] * (camera.line_light - camera.floor_light)
    image = developed(light.astype(np.float32), camera.look, number)
    chosen = np.linspace(0.1 * height, 0.9 * height, 9).round() + 0.5
    is_dark = bool(camera.line_light @ LUMINANCE < camera.floor_light @ LUMINANCE)
    at = np.interp(chosen, rows, middle)
    return LinePlace(
        image,
        is_turned=False,
        is_dark=is_dark,
        width_px=width_px,
        rows_px=tuple(chosen.tolist()),
        x_px=at,
        widths_px=np.full(len(at), width_px),
    )


def developed(light: FloatImage, look: CameraLook, seed: int) -> BgrImage:
    """Return the image of white light (H, W, 3) that has its exposure and shading already, compressed as in a dataset.

    Compression takes a part of the noise, so the noise of the sensor must be larger than that of the image.
    """
    look = look.model_copy(update={"white_balance_adaption": 1.0, "shading_right_ev": 0.0, "shading_down_ev": 0.0})
    response = CameraResponse.from_look(look, (1.0, 1.0, 1.0), seed, Render().jpeg_quality, light.shape[1])
    metered = float(np.median(light @ LUMINANCE.astype(np.float32)))
    pixels = develop(light, replace(response, brightness=metered), metered, 1)
    return np.ascontiguousarray(compressed(pixels, response.jpeg_quality)[..., ::-1])


def _blur_px(variance: float) -> float:
    return _within(np.sqrt(max(variance, 0.0)), 0.0, 5.0)


def _within(value: float, low: float, high: float) -> float:
    return float(min(max(value, low), high))
