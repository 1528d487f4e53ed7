"""The floor of a look whose texture was measured in photographs: an image that repeats, and sheets along the line."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from configs.schema.appearance.paint import Paint
from diagnosis.photographs.floor_measures import FloorMeasures
from diagnosis.photographs.look_settings import LookSetting
from sensors.camera.colour import paint_rgb

FLOOR_IMAGE = "floor.png"
"""Name of the image of the floor, beside the file of the look."""
WHITE_REFLECTANCE = 0.95
"""Reflectance of white in that image, so that bright spots of a light floor are not cut off."""
_TILE_WIDTHS = 4
_MIN_TILE_PX, _MAX_TILE_PX = 512, 2048
"""Side of the image, in widths of the photographs, and its bounds."""
_SEED = 0


@dataclass(frozen=True)
class MeasuredFloor:
    """A floor with the texture of photographs."""

    measures: FloorMeasures
    line_width_m: float
    m_per_px: float
    """Size of a pixel of the photographs on the floor."""
    photograph_width_px: int
    angles: tuple[float, float]
    """Angle of the optical axis below the horizon, and horizontal field of view [deg]."""

    @property
    def tile_px(self) -> int:
        """Return the side of the image of the floor."""
        return min(max(_TILE_WIDTHS * self.photograph_width_px, _MIN_TILE_PX), _MAX_TILE_PX)

    def png(self, paint: Paint, amount: float) -> bytes:
        """Return the image of the floor, which repeats without a seam.

        Args:
            paint: Colour of the floor, and mean reflectance of what is beside the line.
            amount: Factor on the contrast of the texture.
        """
        reflectance = self.measures.texture.tile(self.tile_px, amount, _SEED) / self.measures.beside
        linear = np.clip(reflectance[..., None] * np.array(paint_rgb(paint)) / WHITE_REFLECTANCE, 0, 1)
        # The transfer function of sRGB, IEC 61966-2-1.
        coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
        return cv2.imencode(".png", np.rint(255 * coded[..., ::-1]).astype(np.uint8))[1].tobytes()

    def settings(self, paint: Paint, reflects: str, colour: str) -> Iterator[LookSetting]:
        """Yield the settings of floor and sheets.

        Args:
            paint: Colour of the floor, and mean reflectance of what is beside the line.
            reflects: What set the reflectance.
            colour: What set the colour.
        """
        spread, width_m = 100 * self.measures.texture.spread, round(self.tile_px * self.m_per_px, 4)
        yield LookSetting(("assets",), ".", "folder of the image of the floor")
        yield LookSetting(
            ("floor", "material"), "image", "texture of the photographs; --floor chooses another material"
        )
        yield LookSetting(("floor", "dirt"), 0, "marks of use are a part of the texture")
        yield LookSetting(("floor", "stains"), 0, "")
        texture = f"random texture: light of the floor without uneven lighting, with a spread of {spread:.1f} %"
        yield LookSetting(("floor", "image", "file"), FLOOR_IMAGE, texture)
        scale = f"{self.tile_px} px of {1000 * self.m_per_px:.3f} mm, which follow from --line-width-mm"
        yield LookSetting(("floor", "image", "width_m"), width_m, scale)
        yield LookSetting(("floor", "image", "right_m"), {"uniform": [0, width_m]}, "another part of it in each run")
        yield LookSetting(("floor", "image", "up_m"), {"uniform": [0, width_m]}, "")
        yield LookSetting(("floor", "image", "white_reflectance"), WHITE_REFLECTANCE, f"{reflects}; {colour}")
        yield from self._sheets(paint)

    def _sheets(self, paint: Paint) -> Iterator[LookSetting]:
        sheets = self.measures.sheets
        if sheets is None:
            yield LookSetting(("line_sheets", "width_m"), 0, "no sheets along the line are visible")
            return
        where = f"the floor beside the line has another light; visible on {sheets.visible} of {sheets.sides} sides"
        yield LookSetting(("line_sheets", "width_m"), round(sheets.width * self.line_width_m, 4), where)
        yield LookSetting(("line_sheets", "shift_m"), round(min(sheets.shift * self.line_width_m, 0.1), 4), "")
        light = f"their light is {sheets.ratio:.2f} times that of the floor beside them"
        reflectance = min(paint.reflectance / self.measures.beside * sheets.ratio, 0.95)
        yield LookSetting(("line_sheets", "paint", "reflectance"), round(reflectance, 4), light)
        yield LookSetting(("line_sheets", "paint", "hue_deg"), paint.hue_deg, "")
        yield LookSetting(("line_sheets", "paint", "saturation"), paint.saturation, "")
