"""Correction of a fitted look by rendered images, which are measured like the photographs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.photographs.camera_fit import CameraTarget, corrected
from diagnosis.photographs.fitted_look import FittedLook, Texture
from diagnosis.photographs.floor_measures import FloorMeasures
from diagnosis.photographs.image_figures import ImageFigures
from diagnosis.photographs.line_place import find_lines
from diagnosis.photographs.measured_floor import MeasuredFloor
from diagnosis.photographs.measures import PhotographMeasures, median_light, median_of, shading_ev, vignetting
from pipeline.look_from_photographs.fit import LOOK
from pipeline.look_from_photographs.views import ViewGeometry, look_views
from pipeline.preview import Engine
from pipeline.preview.engines import render_views
from pipeline.preview.views import PreviewImage
from symolo.core.errors import RunFailed
from symolo.core.files.atomic_files import write_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report

ROUNDS = 3
"""Number of corrections."""
MIN_IMAGES, MAX_IMAGES = 8, 12
"""Number of images of a round: that of the photographs, within these bounds."""
_MAX_TEXTURE_FACTOR = 3.0
"""Largest factor by which one correction changes the amount of a texture."""


@dataclass(frozen=True)
class RenderSettings:
    """How images for a correction are rendered."""

    geometry: ViewGeometry
    workers: int
    seed: int = 0


def refined(look: FittedLook, settings: RenderSettings, report: Report) -> FittedLook:
    """Return the look whose rendered images have the measures of the photographs, as far as its settings reach.

    Each of `ROUNDS` corrections renders images of the line as in the photographs, at other places, and moves each
    setting by what its measure lacks. The places and the random draws are the same in all rounds, so the same
    photographs, seed and machine give the same look.

    Raises:
        RunFailed: No image could be rendered, or none shows the line.
    """
    look = replace(look, texture=look.texture or _first_texture(look))
    for number in range(ROUNDS):
        report.say(f"correction {number + 1} of {ROUNDS}")
        look = _corrected(look, _rendered(look, settings, report))
    report.say("images of the result")
    return replace(look, rendered=_rendered(look, settings, report))


def _rendered(look: FittedLook, settings: RenderSettings, report: Report) -> tuple[PhotographMeasures, ...]:
    """Return the measures of the images of a look."""
    count = min(max(len(look.photographs), MIN_IMAGES), MAX_IMAGES)
    with scratch_folder() as folder:
        file = folder / LOOK
        write_file(file, look.text(folder).encode())
        for name, data in look.files.items():
            write_file(folder / name, data)
        places = [photograph.place for photograph in look.photographs]
        views = list(look_views(str(file), places, settings.geometry, count, settings.seed))
        contrast = look.camera.look.contrast
        return tuple(each.with_light_edges(contrast) for each in measured_images(views, settings.workers, report))


def measured_images(views: Sequence[PreviewImage], workers: int, report: Report) -> tuple[PhotographMeasures, ...]:
    """Return the measures of rendered images, without those whose line is not recognised.

    Raises:
        RunFailed: No image could be rendered, or none shows the line.
    """
    images, failures = render_views(Engine.CYCLES, views, workers, report)
    if not images:
        raise RunFailed(f"no image could be rendered: {failures[0].problem}")
    numbers = sorted(images)
    places = find_lines([images[number] for number in numbers])
    measured = [
        measures
        for number, place in zip(numbers, places, strict=True)
        if place is not None and (measures := PhotographMeasures.from_place(f"rendered {number}", place))
    ]
    if not measured:
        raise RunFailed("no rendered image shows the line clearly; choose another --base or --floor-reflectance")
    return tuple(measured)


def _corrected(look: FittedLook, rendered: Sequence[PhotographMeasures]) -> FittedLook:
    """Return the look with each setting corrected by what its measure lacks."""
    target = CameraTarget.from_photographs(look.photographs)
    camera = corrected(replace(look.camera, measures=CameraTarget.from_photographs(rendered)), target)
    contrast = camera.look.contrast
    lost = [vignetting(each, contrast) for each in (look.photographs, rendered)]
    vignette = float(np.clip(camera.look.vignetting + lost[0] - lost[1], 0, 1))
    lights = [
        median_of(each, lambda p, loss=loss: median_light(p, contrast, loss))
        for each, loss in zip((look.photographs, rendered), lost, strict=True)
    ]
    brightness = float(np.clip(camera.look.brightness * lights[0] / lights[1], 0.01, 0.9))
    changed = camera.look.model_copy(
        update={"vignetting": vignette, "brightness": brightness, **_shading(look, rendered, *lost)}
    )
    return replace(look, camera=replace(camera, look=changed), texture=_textured(look, rendered))


def _shading(
    look: FittedLook, rendered: Sequence[PhotographMeasures], lost: float, lost_in_rendered: float
) -> dict[str, float]:
    """Return the shading with which the light rises over rendered images as over the photographs."""
    camera, settings = look.camera.look, {}
    for axis, name in enumerate(("shading_right_ev", "shading_down_ev")):
        photographed = median_of(look.photographs, lambda p, axis=axis: shading_ev(p, camera.contrast, lost)[axis])
        reached = median_of(rendered, lambda p, axis=axis: shading_ev(p, camera.contrast, lost_in_rendered)[axis])
        settings[name] = float(np.clip(getattr(camera, name) + photographed - reached, -3, 3))
    return settings


def _first_texture(look: FittedLook) -> Texture:
    return Texture(floor=1.0) if isinstance(look.floor, MeasuredFloor) else Texture()


def _textured(look: FittedLook, rendered: Sequence[PhotographMeasures]) -> Texture:
    """Return the texture with which floor and line come nearer to those of the photographs."""

    def factor(figure: Callable[[ImageFigures], float]) -> float:
        ratio = median_of(look.photographs, lambda p: figure(p.figures)) / median_of(
            rendered, lambda p: figure(p.figures)
        )
        return _bounded(ratio)

    texture = look.texture or _first_texture(look)
    streaked = factor(lambda f: f.line_spread)
    if isinstance(look.floor, MeasuredFloor):
        photographed, reached = (_spread_in(each, look, look.floor) for each in (look.photographs, rendered))
        return texture.times(_bounded(photographed / max(reached, 1e-6)), streaked)
    # The fall of the light is a part of the mottling, so that the texture must change by more than the whole.
    return texture.times(factor(lambda f: f.mottling_percent) ** 2, streaked)


def _spread_in(images: Sequence[PhotographMeasures], look: FittedLook, floor: MeasuredFloor) -> float:
    """Return the spread of the texture of the floor as images show it, through the lens."""
    camera = look.camera.look
    lens = camera.model_copy(update={"vignetting": vignetting(images, camera.contrast), "lens_blur_px": 0.0})
    return FloorMeasures.from_photographs(images, lens, *floor.angles).texture.spread


def _bounded(factor: float) -> float:
    return float(np.clip(factor, 1 / _MAX_TEXTURE_FACTOR, _MAX_TEXTURE_FACTOR))
