"""Why a camera's images differ from the simulated ones: geometry first, then levels, noise and sharpness.

Geometry is that of the line's edges and needs no simulated images. The other aspects compare the same places of the
floor in measured and simulated images. The fitted geometry gives these places, and the aspects are left out where there
are none.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import exp, sqrt
from typing import Any

import numpy as np

from diagnosis.camera.case import CameraCase, ImagePixels
from diagnosis.camera.features.edge_points import EdgeProfiles, measured_edges, profiles
from diagnosis.camera.features.levels import LevelModel
from diagnosis.camera.features.line_points import LineEdges, edge_candidates, expected_edges
from diagnosis.camera.features.noise import NoiseModel
from diagnosis.camera.features.patches import floor_patches
from diagnosis.camera.features.response import luminance
from diagnosis.camera.features.sharpness import MIN_WIDTH_PX, REACH_PX, SharpnessModel
from diagnosis.camera.fit import CameraFit, CameraSelection, NamedParameter, fitted, select_parameters
from diagnosis.camera.geometry import REACHES, EdgeModel, measured_geometry
from diagnosis.camera.model import CameraModel
from diagnosis.camera.residual_structure import RemainingStructure, remaining_structure
from diagnosis.camera.views import GEOMETRY, CameraView
from diagnosis.inference.gain import Gain, gain_of_sizes
from symolo.core.arrays import Array

MAX_PATCHES = 1500
MAX_EDGES = 400
MIN_PATCHES, MIN_EDGES = 60, 30
MIN_GAIN = 0.1
"""Smallest gain on held-out images of an aspect in which a parameter may be named."""
MAX_MOVED_S = 0.002
"""Time over which the speed of the image is measured."""


@dataclass(frozen=True)
class CameraAspect:
    """The result for one kind of measurement: geometry, levels, noise or sharpness."""

    model: CameraModel
    selection: CameraSelection
    gain: Gain | None
    remaining_structure: RemainingStructure | None

    @property
    def name(self) -> str:
        return self.model.name

    @property
    def fit(self) -> CameraFit:
        return self.selection.fit

    def value(self, place: int, case: CameraCase) -> tuple[float, float]:
        """Return value and standard error of a parameter in its unit.

        The value is a factor for a `_scale`, the whole blur or exposure time, and else a difference from the nominal
        camera.
        """
        parameter = self.model.parameters[place]
        deviation = float(self.fit.x[place]) * parameter.tolerance
        error = float(np.sqrt(self.fit.covariance[place, place])) * parameter.tolerance
        if parameter.name.endswith("_scale"):
            return exp(deviation), exp(deviation) * error
        look = case.look.camera
        # Blurs add up as variances, so the squares of these two are fitted.
        squared = {"lens_blur": look.lens_blur_px, "exposure_time": look.exposure_time_s}
        if parameter.name not in squared:
            return deviation, error
        root = sqrt(max(squared[parameter.name] ** 2 + deviation, 0.0))
        return root, error / (2.0 * max(root, sqrt(error)))

    @property
    def is_better(self) -> bool:
        """Return whether the fitted parameters are better than the nominal ones, named or not."""
        return bool(self.selection.named) or (self.gain is not None and self.gain.low > 0.0)


@dataclass(frozen=True)
class CameraDiagnosis:
    """The result of a camera identification."""

    case: CameraCase
    geometry: CameraAspect
    edges: EdgeModel
    photometry: tuple[CameraAspect, ...]
    left_out: tuple[str, ...]
    """Aspects that could not be measured, each with the reason."""

    @cached_property
    def aspects(self) -> tuple[CameraAspect, ...]:
        return (self.geometry, *self.photometry)

    @property
    def named(self) -> list[tuple[CameraAspect, NamedParameter]]:
        return [(aspect, named) for aspect in self.aspects for named in aspect.selection.named]

    def answer(self) -> dict[str, Any]:
        """Return the result for programs."""
        effects = []
        for aspect, named in self.named:
            value, std = aspect.value(named.place, self.case)
            effects.append(
                {
                    "name": named.parameter.name,
                    "part": aspect.name,
                    "value": round(value, 6),
                    "std": round(std, 6),
                    "unit": named.parameter.unit,
                    "confidence": round(named.confidence, 4),
                    "ambiguous_with": list(named.ambiguous_with),
                }
            )
        unexplained = [
            {"part": aspect.name, "covariate": aspect.remaining_structure.covariate}
            for aspect in self.aspects
            if aspect.remaining_structure
        ]
        heldout = {
            aspect.name: {
                "unit": aspect.model.unit,
                "before": round(gain.before, 4),
                "after": round(gain.after, 4),
                "gain": round(gain.value, 4),
                "gain_low": round(gain.low, 4),
                "gain_high": round(gain.high, 4),
            }
            for aspect in self.aspects
            if (gain := aspect.gain) is not None
        }
        answer: dict[str, Any] = {"effects": effects, "unexplained": bool(unexplained), "heldout": heldout}
        if unexplained:
            answer["unexplained_where"] = unexplained
        return answer | {"not_measured": list(self.left_out)}


def diagnose_camera(case: CameraCase) -> CameraDiagnosis:
    """Identify what differs between the images and the nominal camera.

    Raises:
        InputError: Too little of the line is seen.
    """
    edges = measured_geometry(case, [luminance(frame.image, case.response.contrast) for frame in case.frames])
    column, row = edges.edges.pixels.T
    geometry = _aspect(edges, {"column": column, "row": row, "time": _time_s(case, edges)})
    if not case.is_simulated:
        why = "exposure, white balance, vignetting, glare, tone, blur, sharpening and noise: no simulated images"
        return CameraDiagnosis(case, geometry, edges, (), (why,))
    photometry, left_out = [], []
    x = geometry.fit.x
    patches = floor_patches(case, x)
    if len(patches) >= MIN_PATCHES:
        levels = LevelModel(case.heldout, patches, case.response, case.size_px).thinned(MAX_PATCHES)
        column, row = np.repeat(levels.patches.at, 3, axis=0).T
        level = levels.patches.simulated.ravel()
        photometry += [
            _aspect(levels, {"column": column, "row": row, "time": _time_s(case, levels), "level": level}),
            _aspect(NoiseModel(case.heldout, patches, case.response), {}),
        ]
    else:
        left_out.append("exposure, colour and noise: too little plain floor is seen in both")
    sharpness = _sharpness(case, edges.edges, x)
    if sharpness is not None:
        photometry.append(_aspect(sharpness, {}))
    else:
        left_out.append("blur and sharpening: the line is too narrow in the images")
    return CameraDiagnosis(case, geometry, edges, tuple(photometry), tuple(left_out))


def _time_s(case: CameraCase, model: CameraModel) -> Array:
    """Return the time of each sample, (N,)."""
    return np.array([frame.t_s for frame in case.frames])[model.frame]


def _aspect(model: CameraModel, covariates: Mapping[str, Array]) -> CameraAspect:
    """Select the parameters of a model; `covariates` (N,) are those on which its residuals may depend."""
    selection = select_parameters(model)
    gain = heldout_gain(model, selection.fit.x)
    if selection.named and gain is not None and (gain.value < MIN_GAIN or gain.low <= 0.0):
        # A name that the held-out images contradict, or hardly confirm, is withdrawn.
        selection = CameraSelection(selection.nominal, selection.nominal, ())
        gain = heldout_gain(model, selection.fit.x)
    return CameraAspect(model, selection, gain, remaining_structure(model, selection.fit, covariates))


def heldout_gain(model: CameraModel, x: Array) -> Gain | None:
    """Return the gain of deviations x (P,) over none on the held-out samples, drawn by whole images.

    None where fewer than two images are held out.
    """
    residuals = np.abs([model.residuals(np.zeros_like(x)), model.residuals(x)])
    known = model.heldout & np.isfinite(residuals).all(axis=0)
    if len(np.unique(model.frame[known])) < 2:
        return None
    return gain_of_sizes([(residuals[:, known], model.frame[known])])


def _sharpness(case: CameraCase, real_edges: LineEdges, x: Array) -> SharpnessModel | None:
    """Return the model of the measured profiles, based on the blur of the simulated ones; None with too few edges."""
    nominal = CameraView(case, np.zeros_like(x))
    black = np.zeros((*case.size_px[::-1], 3), np.uint8)
    simulated = [black if frame.simulated is None else frame.simulated for frame in case.frames]
    expected = expected_edges(nominal, edge_candidates(case.arena), margin_px=REACH_PX + 1)
    light = [luminance(image, case.response.contrast) for image in simulated]
    edges, good = measured_edges(expected, light, REACHES[-1] * case.size_px[0], dark=case.line_is_dark)
    good &= np.array([frame.simulated is not None for frame in case.frames])[edges.frame]
    base = _sharpness_model(nominal, edges.some(good), simulated)
    real = _sharpness_model(CameraView(case, x), real_edges, [frame.image for frame in case.frames])
    if base is None or real is None:
        return None
    return real.based_on(base, fitted(base, (0,), np.zeros(len(base.parameters))).x)


def _sharpness_model(view: CameraView, edges: LineEdges, images: list[ImagePixels]) -> SharpnessModel | None:
    """Return the model of profiles across edges that show enough of the line; None with too few of them."""
    wide = np.flatnonzero(edges.width_px > MIN_WIDTH_PX)
    edges = edges.some(wide[:: max(1, len(wide) // MAX_EDGES)])
    if len(edges) < MIN_EDGES:
        return None
    case = view.case
    profile = profiles(edges, [image @ np.array([0.299, 0.587, 0.114]) / 255.0 for image in images], REACH_PX)
    along, values = profile.along_px[::2], profile.light[:, ::2]
    later = view.x.copy()
    place = next(k for k, parameter in enumerate(GEOMETRY) if parameter.name == "time_offset")
    later[place] += MAX_MOVED_S / GEOMETRY[place].tolerance
    motion = CameraView(case, later).pixels(edges) - view.pixels(edges)
    speed = (motion * edges.outwards).sum(axis=1) / MAX_MOVED_S
    outside = np.median(values[:, along > 0.6 * REACH_PX])
    # The level of the line is read in the middle where it is widest, because blur mixes in least of the floor there.
    widest = np.argsort(edges.width_px)[-max(5, len(values) // 5) :]
    deepest = np.argmin(np.abs(along[None, :] + 0.5 * edges.width_px[widest, None]), axis=1)
    inside = np.median(values[widest, deepest])
    grey = np.rint(255 * np.array([[[outside] * 3, [inside] * 3]])).astype(np.uint8)
    floor, line = luminance(grey, case.response.contrast)[0].tolist()
    return SharpnessModel(
        case.heldout,
        edges.frame,
        EdgeProfiles(along, values),
        edges.width_px,
        np.nan_to_num(speed),
        (floor, line),
        case.response,
        case.look.camera.exposure_time_s,
    )
