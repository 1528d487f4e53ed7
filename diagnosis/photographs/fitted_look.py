"""A look with the camera, the colours and the light of photographs, and the file that scenarios take."""

import colorsys
import os
import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np

from configs.references import shipped_names
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.appearance.floors import FloorLook, FloorName
from configs.schema.appearance.paint import Paint
from diagnosis.photographs.camera_fit import CameraTarget, FittedCamera
from diagnosis.photographs.look_settings import LookSetting, Value, yaml_text
from diagnosis.photographs.measured_floor import FLOOR_IMAGE, MeasuredFloor
from diagnosis.photographs.measures import (
    PhotographMeasures,
    light_of,
    median_light,
    median_of,
    shading_ev,
    vignetting,
)
from sensors.camera.colour import LUMINANCE
from symolo.core.arrays import Array
from symolo.core.progress import plural

USUAL_FLOOR_REFLECTANCE = 0.45
"""Reflectance of a grey floor. An image shows only its product with light and exposure, so it is an assumption."""
PAINTED_FLOORS: tuple[FloorName, ...] = tuple(name for name in get_args(FloorName) if name != "image")
"""Materials of floors whose colour is a paint."""
LARGEST_REFLECTANCE = 0.85
SMALLEST_REFLECTANCE = 0.01
_SHADING = ("shading_right_ev", "shading_down_ev")
_MIN_STOPS = 0.02
"""Smallest difference between the exposures of photographs that the look varies."""

_LARGEST_RATIO = 2.0
"""Ratio of the lights of the line, relative to the floor, above which photographs may show different lines."""
_LARGEST_DIFFERENCE = 0.3
"""The same for the difference between their vignettings."""

VARIATION: dict[FloorName, str] = {
    "linoleum": "marbling",
    "ceramic_tile": "variation",
    "parquet": "variation",
    "concrete": "clouding",
    "carpet": "mottling",
    "plywood": "variation",
    "paper_sheets": "variation",
    "vinyl": "variation",
}
"""For each material the setting of how much its reflectance varies."""
_MAX_TEXTURE = 4.0


@dataclass(frozen=True)
class Texture:
    """Amounts of texture, 1 for many marks of use."""

    floor: float = 0.5
    """Amount of `floor.stains`, and of the variation of the material, which is usual at 0.5. For a floor with the
    texture of the photographs, a factor on its contrast."""
    line: float = 0.5
    """Amount of `tape.streaks`."""

    def times(self, floor: float, line: float) -> "Texture":
        """Return the amounts multiplied by these factors."""
        return Texture(min(self.floor * floor, _MAX_TEXTURE), min(self.line * line, 1.0))


@dataclass(frozen=True)
class FittedLook:
    """A look that was fitted to photographs."""

    name: str
    base: str
    """Look that has all other settings: name of a shipped one, or a path."""
    photographs: tuple[PhotographMeasures, ...]
    camera: FittedCamera
    floor: FloorName | MeasuredFloor
    """Material, or a floor with the texture of the photographs."""
    floor_reflectance: float
    reflectance_is_assumed: bool
    folder: str = "."
    """Folder of the photographs; their names are relative to it."""
    texture: Texture | None = None
    """Texture with which rendered images are like the photographs; None for that of the base look."""
    rendered: tuple[PhotographMeasures, ...] = ()
    """Measures of rendered images of this look; empty if none were rendered."""

    @property
    def settings(self) -> tuple[LookSetting, ...]:
        """All settings in the order of the file."""
        return (*self._surfaces(), *self._camera())

    @property
    def size_px(self) -> tuple[int, int]:
        """Return width and height of the photographs."""
        return self.photographs[0].place.upright_size_px

    def settings_to_use(self, file: str) -> str:
        """Return the options of a command that makes images with this look."""
        width, height = self.size_px
        return f"--set {shlex.quote(f'look={file}')} --set render.width_px={width} --set render.height_px={height}"

    def _surfaces(self) -> Iterator[LookSetting]:
        saturation, photographed = self.camera.look.saturation, CameraTarget.from_photographs(self.photographs)
        assumed = "assumed; --floor-reflectance sets it" if self.reflectance_is_assumed else "as given"
        colour = f"colour of the floor, R G B {_levels(photographed.floor_rgb)}"
        if isinstance(self.floor, MeasuredFloor):
            reflects = f"the floor reflects {self.floor_reflectance:.3f} of the light ({assumed})"
            yield from self.floor.settings(self._floor_paint(), reflects, colour)
        else:
            yield LookSetting(("floor", "material"), self.floor, "as chosen by --floor")
            yield from _paint(("floor", self.floor, "paint"), self._floor_paint(), assumed, colour)
            if self.texture is not None:
                yield from self._floor_texture(self.floor, self.texture)
        yield LookSetting(("line",), "tape", "")
        share = float(self.camera.line_light @ LUMINANCE / (self.camera.floor_light @ LUMINANCE))
        ratios = np.array([self._line_share(photograph) for photograph in self.photographs])
        ratios *= share / np.median(ratios)
        paint = paint_of(self.camera.line_light, share * self.floor_reflectance, saturation)
        spread = f"{ratios.min():.3f} to {ratios.max():.3f}"
        reflects = f"the line returns {share:.3f} of the light of the floor ({spread}); gloss and dust are part of it"
        colour = f"colour of the line, R G B {_levels(photographed.line_rgb)}"
        yield from _paint(("tape", "paint"), paint, reflects, colour)
        if self.texture is not None:
            spread = _spread(self.photographs, lambda p: p.figures.line_spread)
            streaks = self._varied(self.texture.line, 1.0, lambda p: p.figures.line_spread)
            yield LookSetting(("tape", "streaks"), streaks, f"spread of grey values on the line: {spread}")

    def _floor_paint(self) -> Paint:
        return paint_of(self.camera.floor_light, self.floor_reflectance, self.camera.look.saturation)

    def _floor_texture(self, floor: FloorName, texture: Texture) -> Iterator[LookSetting]:
        name = VARIATION[floor]
        section = getattr(FloorLook(), floor)
        usual, bound = getattr(section, name), 0.5 if floor == "paper_sheets" else 1.0
        spread = f"mottling of the floor: {_spread(self.photographs, lambda p: p.figures.mottling_percent)} %"
        variation = self._varied(2 * usual * texture.floor, bound, lambda p: p.figures.mottling_percent)
        yield LookSetting(("floor", floor, name), variation, spread)
        stains = self._varied(texture.floor, 1.0, lambda p: p.figures.mottling_percent)
        yield LookSetting(("floor", "stains"), stains, "likewise")

    def _varied(self, value: float, bound: float, measure: Callable[[PhotographMeasures], float]) -> Value:
        """Return a range about a value that is as wide, relative to it, as that of the measure in the photographs."""
        values = np.array([measure(photograph) for photograph in self.photographs])
        low, high = value * np.nanmin(values) / np.nanmedian(values), value * np.nanmax(values) / np.nanmedian(values)
        ends = [round(float(min(end, bound)), 3) for end in (low, high)]
        return ends[0] if ends[0] == ends[1] else {"uniform": ends}

    def _camera(self) -> Iterator[LookSetting]:
        look, reasons = self.camera.look, self._reasons()
        yield LookSetting(("camera", "name"), self.name, "")
        yield LookSetting(("camera", "description"), f"Camera of {plural(len(self.photographs), 'photograph')}", "")
        # All fields, also those without effect: the camera of the base look may have others.
        for field in CameraLook.model_fields:
            value = getattr(look, field)
            if field in {"name", "description"}:
                continue
            if field == "compensation_ev":
                yield LookSetting(("camera", field), *self._compensation())
            elif field in _SHADING:
                yield LookSetting(("camera", field), *self._shading(_SHADING.index(field)))
            else:
                number = round(value, 5) if isinstance(value, float) else value
                yield LookSetting(("camera", field), number, reasons.get(field, f"as in {self.base}"))

    def _reasons(self) -> dict[str, str]:
        """Return what set each field of the camera that the photographs decide."""
        contrast = self.camera.look.contrast
        each = self.photographs
        lost = [vignetting([photograph], contrast) for photograph in each]
        noise = _spread(each, lambda p: p.floor_noise), _spread(each, lambda p: p.line_noise)
        filtered = {"colour_filter": "the photographs have no colours"} if self.camera.is_monochrome else {}
        return filtered | {
            "brightness": "median light of a photograph, without its vignetting",
            "vignetting": f"fall of the light towards the corners of the floor: {min(lost):.2f} to {max(lost):.2f}",
            "lens_blur_px": f"width of the line's edge, 10 to 90 %: {_spread(each, lambda p: p.edge_px)} px",
            "sharpening": f"overshoot beside the line's edge: {_spread(each, lambda p: 100 * p.overshoot)} %",
            "shot_noise": f"noise on the floor: {noise[0]} grey values",
            "read_noise": f"noise on the line: {noise[1]} grey values",
            "exposure_time_s": "photographs do not separate motion from the blur of the lens",
            "defocus_share": "part of lens_blur_px",
            "white_balance_adaption": "the floor then has its colour of the photographs",
        }

    def _compensation(self) -> tuple[Value, str]:
        # Relative to one another: rendered images may have changed the brightness and the vignetting of the camera.
        contrast = self.camera.look.contrast
        lost = vignetting(self.photographs, contrast)
        lights = np.array([median_light(photograph, contrast, lost) for photograph in self.photographs])
        stops = np.log2(lights / np.median(lights))
        low, high = float(stops.min()), float(stops.max())
        source = "from the darkest to the brightest photograph"
        if high - low < _MIN_STOPS:
            return 0.0, source
        return {"uniform": [round(low, 3), round(high, 3)]}, source

    def _shading(self, axis: int) -> tuple[Value, str]:
        # Relative to their median, as for the compensation.
        contrast = self.camera.look.contrast
        lost = vignetting(self.photographs, contrast)
        slopes = np.array([shading_ev(photograph, contrast, lost)[axis] for photograph in self.photographs])
        ends = getattr(self.camera.look, _SHADING[axis]) + slopes - np.median(slopes)
        low, high = (round(float(np.clip(end, -3, 3)), 3) for end in (ends.min(), ends.max()))
        where = "from the left border to the right" if axis == 0 else "from the upper border to the lower"
        source = f"rise of the light of the floor {where}, in stops"
        return (low if high - low < _MIN_STOPS else {"uniform": [low, high]}), source

    @property
    def files(self) -> dict[str, bytes]:
        """Return the files that the look needs beside its own, by name: the image of a measured floor."""
        if not isinstance(self.floor, MeasuredFloor):
            return {}
        amount = 1.0 if self.texture is None else self.texture.floor
        return {FLOOR_IMAGE: self.floor.png(self._floor_paint(), amount)}

    @property
    def doubts(self) -> tuple[str, ...]:
        """Return what suggests that the photographs show different lines or light, one sentence each."""
        shares = [self._line_share(photograph) for photograph in self.photographs]
        lost = [vignetting([photograph], self.camera.look.contrast) for photograph in self.photographs]
        cure = "look at the marked edges in report.html, and leave out photographs of which another line was taken"
        doubts = []
        if max(shares) > _LARGEST_RATIO * min(shares):
            doubts.append(f"the line has from {min(shares):.2f} to {max(shares):.2f} of the light of the floor: {cure}")
        if max(lost) - min(lost) > _LARGEST_DIFFERENCE:
            doubts.append(f"the vignetting of single photographs is from {min(lost):.2f} to {max(lost):.2f}: {cure}")
        return tuple(doubts)

    def _line_share(self, photograph: PhotographMeasures) -> float:
        """Return the light of the line as a share of that of the floor, without regard to vignetting and glare."""
        line, floor = (
            light_of(rgb, self.camera.look.contrast) @ LUMINANCE for rgb in (photograph.line_rgb, photograph.floor_rgb)
        )
        return float(line / floor)

    def text(self, folder: Path) -> str:
        """Return the file of the look, for a place in this folder."""
        base = self.base if self.base in shipped_names("look") else os.path.relpath(self.base, folder)
        width, height = self.size_px
        names = ", ".join(photograph.name for photograph in self.photographs)
        lines = [
            f"# Look of {plural(len(self.photographs), 'photograph')} in {self.folder}: {names}.",
            f"# Blur and noise are those of images of {width} x {height} px.",
            "# Each comment names what set the value: median over the photographs, smallest to largest.",
            f"extends: {yaml_text(base)}",
            f"name: {self.name}",
            f"description: Floor, line and camera of {plural(len(self.photographs), 'photograph')}",
        ]
        before: tuple[str, ...] = ()
        for setting in self.settings:
            *parents, key = setting.path
            shared = _common(before, tuple(parents))
            lines += [f"{'  ' * depth}{parents[depth]}:" for depth in range(shared, len(parents))]
            comment = f"  # {setting.source}" if setting.source else ""
            lines.append(f"{'  ' * len(parents)}{key}: {setting.text}{comment}")
            before = tuple(parents)
        return "\n".join(lines) + "\n"


def paint_of(light: Array, reflectance: float, saturation: float) -> Paint:
    """Return the paint that has the colour of `light` in an image of a camera with this `saturation`.

    Args:
        light: (3,), linear.
        reflectance: Luminous reflectance, brought into the bounds of a paint.
        saturation: Factor of the camera on the saturation of colours; with 0, the paint is grey.
    """
    grey = float(light @ LUMINANCE)
    rgb = np.clip(grey + (light - grey) / saturation, 0, None) if saturation > 0 else np.full(3, grey)
    hue, depth, _ = colorsys.rgb_to_hsv(*(rgb / max(float(rgb.max()), 1e-9)).tolist())
    within = min(max(reflectance, SMALLEST_REFLECTANCE), 0.95)
    return Paint(reflectance=round(within, 4), hue_deg=round(360 * hue, 1), saturation=round(depth, 4))


def floor_reflectance_for(camera: FittedCamera) -> float:
    """Return the usual reflectance of a floor, or a smaller one if the line would be too bright."""
    share = float(camera.line_light @ LUMINANCE / (camera.floor_light @ LUMINANCE))
    return round(min(USUAL_FLOOR_REFLECTANCE, LARGEST_REFLECTANCE / share), 4)


def _paint(path: tuple[str, ...], paint: Paint, reflects: str, colour: str) -> Iterator[LookSetting]:
    yield LookSetting((*path, "reflectance"), paint.reflectance, reflects)
    yield LookSetting((*path, "hue_deg"), paint.hue_deg, colour)
    yield LookSetting((*path, "saturation"), paint.saturation, "")


def _spread(photographs: Sequence[PhotographMeasures], value: Callable[[PhotographMeasures], float]) -> str:
    values = [value(photograph) for photograph in photographs]
    return f"{median_of(photographs, value):.2f} ({np.nanmin(values):.2f} to {np.nanmax(values):.2f})"


def _levels(rgb: Array) -> str:
    return " ".join(f"{level:.0f}" for level in rgb)


def _common(one: tuple[str, ...], other: tuple[str, ...]) -> int:
    """Return the number of leading keys that two paths share."""
    number = 0
    while number < min(len(one), len(other)) and one[number] == other[number]:
        number += 1
    return number
