"""Why a camera's images differ from the simulated ones: geometry first, then levels, sharpness and noise.

Geometry is that of the line's edges and needs no simulated images. The others compare the same places of the floor,
which the camera just found tells where to look for, and are left out where there are none.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis.camera.case import CameraCase, ImagePixels, Mask
from diagnosis.camera.deviation import value_of
from diagnosis.camera.features.edge_points import EdgeProfiles, edges, profiles
from diagnosis.camera.features.levels import LevelModel
from diagnosis.camera.features.line_points import ExpectedEdges, edge_candidates, expected_edges
from diagnosis.camera.features.noise import NoiseModel
from diagnosis.camera.features.patches import FloorPatches, floor_patches
from diagnosis.camera.features.response import luminance
from diagnosis.camera.features.sharpness import MIN_WIDTH_PX, REACH_PX, SharpnessModel
from diagnosis.camera.fit import CameraFit, CameraModel, CameraSelection, NamedCameraNumber, choose, fitted
from diagnosis.camera.geometry import EdgeModel, measure
from diagnosis.camera.residual_structure import RemainingStructure, remaining_structure
from diagnosis.camera.views import CameraView
from diagnosis.inference.gain import Gain, gain_of_sizes
from symolo.core.arrays import Array

MAX_PATCHES = 1500
MAX_EDGES = 400
MIN_PATCHES, MIN_EDGES = 60, 30
MIN_GAIN = 0.1
"""Least gain on held-out images of an aspect in which a number may be named."""
MAX_MOVED_S = 0.002
"""Time over which the speed of the image is measured."""


@dataclass(frozen=True)
class CameraAspect:
    """The result for one kind of measurement: geometry, levels, noise or sharpness."""

    name: str
    unit: str
    """Unit of the samples."""
    model: CameraModel
    heldout: Mask
    chosen: CameraSelection
    gain: Gain | None
    remaining_structure: RemainingStructure | None

    @property
    def fit(self) -> CameraFit:
        return self.chosen.fit

    def value(self, place: int, case: CameraCase) -> tuple[float, float]:
        """Return value and standard error of a number in its unit."""
        sd = float(np.sqrt(self.fit.covariance[place, place]))
        return value_of(self.model.numbers[place], float(self.fit.x[place]), sd, case)

    @property
    def counts(self) -> bool:
        """Return whether the fitted numbers are better than the nominal ones, named or not."""
        return bool(self.chosen.choices) or (self.gain is not None and self.gain.low > 0.0)


@dataclass(frozen=True)
class CameraDiagnosis:
    """The result of a camera identification."""

    case: CameraCase
    geometry: CameraAspect
    edges: EdgeModel
    photometry: tuple[CameraAspect, ...]
    left_out: tuple[str, ...]
    """What could not be measured, with the reason."""

    @cached_property
    def parts(self) -> tuple[CameraAspect, ...]:
        return (self.geometry, *self.photometry)

    @property
    def named(self) -> list[tuple[CameraAspect, NamedCameraNumber]]:
        return [(part, choice) for part in self.parts for choice in part.chosen.choices]

    def answer(self) -> dict[str, Any]:
        """Return the result for programs."""
        effects = [
            {
                "name": choice.number.name,
                "part": part.name,
                **_rounded(part.value(choice.place, self.case)),
                "unit": choice.number.unit,
                "confidence": round(choice.confidence, 4),
                "ambiguous_with": list(choice.ambiguous_with),
            }
            for part, choice in self.named
        ]
        left = [
            {"part": part.name, "covariate": part.remaining_structure.covariate}
            for part in self.parts
            if part.remaining_structure
        ]
        answer: dict[str, Any] = {"effects": effects, "unexplained": bool(left), "heldout": {}}
        if left:
            answer["unexplained_where"] = left
        for part in self.parts:
            if gain := part.gain:
                numbers = (gain.before, gain.after, gain.value, gain.low, gain.high)
                names = ("before", "after", "gain", "gain_low", "gain_high")
                answer["heldout"][part.name] = {"unit": part.unit} | {
                    name: round(number, 4) for name, number in zip(names, numbers, strict=True)
                }
        answer["not_measured"] = list(self.left_out)
        return answer


def diagnose_camera(case: CameraCase) -> CameraDiagnosis:
    """Identify what differs between the images and the nominal camera.

    Raises:
        InputError: Too little of the line is seen.
    """
    light = [luminance(frame.image, case.response.contrast) for frame in case.frames]
    model = measure(case, light)
    geometry = _part("geometry", "px", model, model.heldout, _places(model))
    x = geometry.fit.x
    if not case.is_simulated:
        why = "exposure, white balance, vignetting, glare, tone, blur, sharpening and noise: no simulated images"
        return CameraDiagnosis(case, geometry, model, (), (why,))
    aspects, left_out = [], []
    seen = floor_patches(case, x)
    if len(seen.frame) >= MIN_PATCHES:
        aspects += [_levels(case, seen), _noise(case, seen)]
    else:
        left_out.append("exposure, colour and noise: too little plain floor is seen in both")
    sharp = _sharpness(case, model, x)
    if sharp:
        aspects.append(sharp)
    else:
        left_out.append("blur and sharpening: the line is too narrow in the images")
    return CameraDiagnosis(case, geometry, model, tuple(aspects), tuple(left_out))


def _part(name: str, unit: str, model: CameraModel, heldout: Mask, covariates: Mapping[str, Array]) -> CameraAspect:
    chosen = choose(model)
    gain = heldout_gain(model, heldout, chosen.fit.x)
    if chosen.choices and gain is not None and (gain.value < MIN_GAIN or gain.low <= 0.0):
        # A name that the held-out images contradict, or hardly confirm, is withdrawn.
        chosen = CameraSelection(chosen.nominal, chosen.nominal, ())
        gain = heldout_gain(model, heldout, chosen.fit.x)
    return CameraAspect(name, unit, model, heldout, chosen, gain, remaining_structure(model, chosen.fit, covariates))


def heldout_gain(model: CameraModel, heldout: Mask, x: Array) -> Gain | None:
    """Return the gain of deviations x (P,) over none on samples (N,) held out, drawn by whole images.

    None where fewer than two images are held out.
    """
    residuals = np.abs([model.residuals(np.zeros_like(x)), model.residuals(x)])
    known = heldout & np.isfinite(residuals).all(axis=0)
    if len(np.unique(model.frame[known])) < 2:
        return None
    return gain_of_sizes([(residuals[:, known], model.frame[known])])


def _places(model: EdgeModel) -> dict[str, Array]:
    t_s = np.array([frame.t_s for frame in model.case.frames])[model.frame]
    return {"column": model.measured[:, 0], "row": model.measured[:, 1], "time": t_s}


def _levels(case: CameraCase, seen: FloorPatches) -> CameraAspect:
    model = LevelModel(seen, case.response, case.heldout, case.size_px).some(MAX_PATCHES)
    t_s = np.array([frame.t_s for frame in case.frames])[model.frame]
    at = np.repeat(model.patches.at, 3, axis=0)
    covariates = {"column": at[:, 0], "row": at[:, 1], "time": t_s, "level": model.patches.simulated.ravel()}
    return _part("levels", "of white", model, model.heldout, covariates)


def _noise(case: CameraCase, seen: FloorPatches) -> CameraAspect:
    model = NoiseModel(seen, case.response, case.heldout)
    return _part("noise", "of its logarithm", model, model.heldout, {})


def _sharpness(case: CameraCase, model: EdgeModel, x: Array) -> CameraAspect | None:
    real = ExpectedEdges(model.points, model.measured, model.outwards, model.width_px)
    nominal = CameraView(case, np.zeros_like(x))
    there = expected_edges(nominal, edge_candidates(case.arena), margin_px=REACH_PX + 1)
    simulated = [frame.simulated for frame in case.frames]
    images = [_grey(p) if p is not None else np.zeros(case.size_px[::-1]) for p in simulated]
    lights = [
        luminance(p, case.response.contrast) if p is not None else np.zeros(case.size_px[::-1]) for p in simulated
    ]
    dark = case.arena.line.reflectance < case.arena.floor_reflectance
    off, good = edges(there, lights, 0.02 * case.size_px[0], dark=dark)
    good &= np.array([p is not None for p in simulated])[there.points.frame]
    there = ExpectedEdges(there.points, there.pixels + off[:, None] * there.outwards, there.outwards, there.width_px)
    of_sim = _sharpness_model(case, nominal, _wide(there, good), images)
    of_real = _sharpness_model(
        case, CameraView(case, x), _wide(real, np.ones(len(real.points), bool)), [_grey(f.image) for f in case.frames]
    )
    if of_sim is None or of_real is None:
        return None
    base = fitted(of_sim, (0,), np.zeros(len(of_sim.numbers)))
    based = of_real.based_on(of_sim, base.x)
    return _part("sharpness", "of the edge's height", based, based.heldout, {})


def _wide(sighting: ExpectedEdges, good: Mask) -> ExpectedEdges:
    """Return some of the edges that show enough of the line, spread evenly over all."""
    kept = np.flatnonzero(good & (sighting.width_px > MIN_WIDTH_PX))
    kept = kept[:: max(1, len(kept) // MAX_EDGES)]
    points = type(sighting.points)(
        sighting.points.frame[kept], sighting.points.on_line[kept], sighting.points.outwards[kept]
    )
    return ExpectedEdges(points, sighting.pixels[kept], sighting.outwards[kept], sighting.width_px[kept])


def _grey(image: ImagePixels) -> Array:
    return image @ np.array([0.299, 0.587, 0.114]) / 255.0


def _sharpness_model(
    case: CameraCase, view: CameraView, sighting: ExpectedEdges, images: list[Array]
) -> SharpnessModel | None:
    if len(sighting.points) < MIN_EDGES:
        return None
    seen = profiles(sighting, images, REACH_PX)
    along, values = seen.along_px[::2], seen.light[:, ::2]
    late = view.x.copy()
    place = next(k for k, number in enumerate(EdgeModel.numbers) if number.name == "time_offset")
    step = MAX_MOVED_S / EdgeModel.numbers[place].tolerance
    late[place] += step
    moved = CameraView(case, late).pixels(sighting.points) - view.pixels(sighting.points)
    speed = (moved * sighting.outwards).sum(axis=1) / MAX_MOVED_S
    outside = np.median(values[:, along > 0.6 * REACH_PX])
    # The level of the line is read in the middle where it is widest, because blur mixes in the least floor there.
    widest = np.argsort(sighting.width_px)[-max(5, len(values) // 5) :]
    deepest = np.argmin(np.abs(along[None, :] + 0.5 * sighting.width_px[widest, None]), axis=1)
    inside = np.median(values[widest, deepest])
    light = luminance(np.rint(255 * np.array([[[outside] * 3, [inside] * 3]])).astype(np.uint8), case.response.contrast)
    floor, line = light[0].tolist()
    return SharpnessModel(
        sighting.points.frame,
        case.heldout,
        EdgeProfiles(along, values),
        sighting.width_px,
        np.nan_to_num(speed),
        (floor, line),
        case.response,
        case.look.camera.exposure_time_s,
    )


def _rounded(value: tuple[float, float]) -> dict[str, float]:
    return {"value": round(value[0], 6), "std": round(value[1], 6)}
