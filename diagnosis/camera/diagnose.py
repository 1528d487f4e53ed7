"""Why a camera's pictures differ from the simulated ones: geometry first, then levels, sharpness and noise.

Geometry is that of the line's edges and needs no simulated pictures. The others compare the same places of the floor,
which the camera just found tells where to look for, and are left out where there are none.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis.camera.case import Mask, Picture, PictureCase
from diagnosis.camera.deviation import found_value
from diagnosis.camera.features.edge_points import EdgeProfiles, edges, profiles
from diagnosis.camera.features.levels import LevelModel
from diagnosis.camera.features.line_points import Sighting, edge_candidates, sighted
from diagnosis.camera.features.noise import NoiseModel
from diagnosis.camera.features.patches import Patches, patches
from diagnosis.camera.features.response import luminance
from diagnosis.camera.features.sharpness import NARROWEST_PX, REACH_PX, SharpnessModel
from diagnosis.camera.fit import Choice, Chosen, Fit, Model, choose, fitted
from diagnosis.camera.gain import PictureGain, picture_gain
from diagnosis.camera.geometry import EdgeModel, measure
from diagnosis.camera.residual_structure import Remains, remains
from diagnosis.camera.views import View
from symolo.core.arrays import Array

MAX_PATCHES = 1500
MAX_EDGES = 400
FEWEST_PATCHES, FEWEST_EDGES = 60, 30
MIN_GAIN = 0.1
"""On pictures held out, of a part of which anything is named."""
MAX_MOVED_S = 0.002
"""Over which the speed of the picture is taken."""


@dataclass(frozen=True)
class Part:
    """What one kind of measurement says."""

    name: str
    unit: str
    """Of its samples."""
    model: Model
    heldout: Mask
    chosen: Chosen
    gain: PictureGain | None
    remains: Remains | None

    @property
    def fit(self) -> Fit:
        return self.chosen.fit

    def found(self, place: int, case: PictureCase) -> tuple[float, float]:
        """A number's value and standard error in its unit."""
        sd = float(np.sqrt(self.fit.covariance[place, place]))
        return found_value(self.model.numbers[place], float(self.fit.x[place]), sd, case)

    @property
    def counts(self) -> bool:
        """Whether the fitted numbers are better than the nominal ones, named or not."""
        return bool(self.chosen.choices) or (self.gain is not None and self.gain.low > 0.0)


@dataclass(frozen=True)
class PictureDiagnosis:
    case: PictureCase
    geometry: Part
    edges: EdgeModel
    photometry: tuple[Part, ...]
    left_out: tuple[str, ...]
    """What could not be looked at, and why."""

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return (self.geometry, *self.photometry)

    @property
    def named(self) -> list[tuple[Part, Choice]]:
        return [(part, choice) for part in self.parts for choice in part.chosen.choices]

    def answer(self) -> dict[str, Any]:
        """The verdict for programs."""
        effects = [
            {
                "name": choice.number.name,
                "part": part.name,
                **_rounded(part.found(choice.place, self.case)),
                "unit": choice.number.unit,
                "confidence": round(choice.confidence, 4),
                "ambiguous_with": list(choice.ambiguous_with),
            }
            for part, choice in self.named
        ]
        left = [{"part": part.name, "covariate": part.remains.covariate} for part in self.parts if part.remains]
        found: dict[str, Any] = {"effects": effects, "unexplained": bool(left), "heldout": {}}
        if left:
            found["unexplained_where"] = left
        for part in self.parts:
            if gain := part.gain:
                numbers = (gain.before, gain.after, gain.value, gain.low, gain.high)
                names = ("before", "after", "gain", "gain_low", "gain_high")
                found["heldout"][part.name] = {"unit": part.unit} | {
                    name: round(number, 4) for name, number in zip(names, numbers, strict=True)
                }
        found["not_looked_at"] = list(self.left_out)
        return found


def diagnose_pictures(case: PictureCase) -> PictureDiagnosis:
    """What differs between the pictures and the nominal camera.

    Raises:
        InputError: Too little of the line is seen.
    """
    light = [luminance(frame.picture, case.response.contrast) for frame in case.frames]
    model = measure(case, light)
    geometry = _part("geometry", "px", model, model.heldout, _places(model))
    x = geometry.fit.x
    if not case.is_simulated:
        why = "exposure, white balance, vignetting, glare, tone, blur, sharpening and noise: no simulated pictures"
        return PictureDiagnosis(case, geometry, model, (), (why,))
    found, left_out = [], []
    seen = patches(case, x)
    if len(seen.frame) >= FEWEST_PATCHES:
        found += [_levels(case, seen), _noise(case, seen)]
    else:
        left_out.append("exposure, colour and noise: too little plain floor is seen in both")
    sharp = _sharpness(case, model, x)
    if sharp:
        found.append(sharp)
    else:
        left_out.append("blur and sharpening: the line is too narrow in the pictures")
    return PictureDiagnosis(case, geometry, model, tuple(found), tuple(left_out))


def _part(name: str, unit: str, model: Model, heldout: Mask, covariates: Mapping[str, Array]) -> Part:
    chosen = choose(model)
    gain = picture_gain(model, heldout, chosen.fit.x)
    if chosen.choices and gain is not None and (gain.value < MIN_GAIN or gain.low <= 0.0):
        # What pictures held out contradict, or hardly confirm, is no discovery.
        chosen = Chosen(chosen.nominal, chosen.nominal, ())
        gain = picture_gain(model, heldout, chosen.fit.x)
    return Part(name, unit, model, heldout, chosen, gain, remains(model, chosen.fit, covariates))


def _places(model: EdgeModel) -> dict[str, Array]:
    t_s = np.array([frame.t_s for frame in model.case.frames])[model.frame]
    return {"column": model.measured[:, 0], "row": model.measured[:, 1], "time": t_s}


def _levels(case: PictureCase, seen: Patches) -> Part:
    model = LevelModel(seen, case.response, case.heldout, case.size_px).some(MAX_PATCHES)
    t_s = np.array([frame.t_s for frame in case.frames])[model.frame]
    at = np.repeat(model.patches.at, 3, axis=0)
    covariates = {"column": at[:, 0], "row": at[:, 1], "time": t_s, "level": model.patches.simulated.ravel()}
    return _part("levels", "of white", model, model.heldout, covariates)


def _noise(case: PictureCase, seen: Patches) -> Part:
    model = NoiseModel(seen, case.response, case.heldout)
    return _part("noise", "of its logarithm", model, model.heldout, {})


def _sharpness(case: PictureCase, model: EdgeModel, x: Array) -> Part | None:
    real = Sighting(model.points, model.measured, model.outwards, model.width_px)
    nominal = View(case, np.zeros_like(x))
    there = sighted(nominal, edge_candidates(case.arena), margin_px=REACH_PX + 1)
    simulated = [frame.simulated for frame in case.frames]
    pictures = [_grey(p) if p is not None else np.zeros(case.size_px[::-1]) for p in simulated]
    lights = [
        luminance(p, case.response.contrast) if p is not None else np.zeros(case.size_px[::-1]) for p in simulated
    ]
    dark = case.arena.line.reflectance < case.arena.floor_reflectance
    off, good = edges(there, lights, 0.02 * case.size_px[0], dark=dark)
    good &= np.array([p is not None for p in simulated])[there.points.frame]
    there = Sighting(there.points, there.pixels + off[:, None] * there.outwards, there.outwards, there.width_px)
    of_sim = _sharpness_model(case, nominal, _wide(there, good), pictures)
    of_real = _sharpness_model(
        case, View(case, x), _wide(real, np.ones(len(real.points), bool)), [_grey(f.picture) for f in case.frames]
    )
    if of_sim is None or of_real is None:
        return None
    base = fitted(of_sim, (0,), np.zeros(len(of_sim.numbers)))
    based = of_real.based_on(of_sim, base.x)
    return _part("sharpness", "of the edge's height", based, based.heldout, {})


def _wide(sighting: Sighting, good: Mask) -> Sighting:
    """Some of the edges of which enough is seen, spread over all."""
    kept = np.flatnonzero(good & (sighting.width_px > NARROWEST_PX))
    kept = kept[:: max(1, len(kept) // MAX_EDGES)]
    points = type(sighting.points)(
        sighting.points.frame[kept], sighting.points.on_line[kept], sighting.points.outwards[kept]
    )
    return Sighting(points, sighting.pixels[kept], sighting.outwards[kept], sighting.width_px[kept])


def _grey(picture: Picture) -> Array:
    return picture @ np.array([0.299, 0.587, 0.114]) / 255.0


def _sharpness_model(case: PictureCase, view: View, sighting: Sighting, pictures: list[Array]) -> SharpnessModel | None:
    if len(sighting.points) < FEWEST_EDGES:
        return None
    seen = profiles(sighting, pictures, REACH_PX)
    along, values = seen.along_px[::2], seen.light[:, ::2]
    late = view.x.copy()
    place = next(k for k, number in enumerate(EdgeModel.numbers) if number.name == "time_offset")
    step = MAX_MOVED_S / EdgeModel.numbers[place].tolerance
    late[place] += step
    moved = View(case, late).pixels(sighting.points) - view.pixels(sighting.points)
    speed = (moved * sighting.outwards).sum(axis=1) / MAX_MOVED_S
    outside = np.median(values[:, along > 0.6 * REACH_PX])
    # In the middle of where the line is widest, where blur has brought least of the floor.
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


def _rounded(found: tuple[float, float]) -> dict[str, float]:
    return {"value": round(found[0], 6), "std": round(found[1], 6)}
