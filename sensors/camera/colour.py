"""Colours: paints from the look, lights from their temperature; linear Rec. 709 throughout."""

import colorsys

import numpy as np

from configs.schema.appearance.camera_look import ColourFilter
from configs.schema.appearance.look import Paint
from symolo.core.arrays import FloatImage, triple

RGB = tuple[float, float, float]
"""Linear Rec. 709 components; reflectances lie within 0 to 1."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear Rec. 709 components (ITU-R BT.709)."""

PANCHROMATIC = np.full(3, 1 / 3)
"""Weights of linear Rec. 709 components in a monochrome sensor. Its response is taken to be the same for all visible
light; that of a real one falls towards both ends of the spectrum."""

_XYZ_TO_RGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)


def paint_rgb(paint: Paint, *, times: float = 1.0) -> RGB:
    """Return the paint's colour at `times` its reflectance; a component is at most 0.95."""
    tint = np.array(colorsys.hsv_to_rgb((paint.hue_deg / 360.0) % 1.0, paint.saturation, 1.0))
    rgb = tint * (paint.reflectance * times / float(tint @ LUMINANCE))
    return triple(np.clip(rgb, 0.0, 0.95))


def light_rgb(temperature_K: float) -> RGB:
    """Return the colour of a light of that correlated temperature, scaled to a luminance of 1.

    From 4000 K on, it is on the daylight locus of CIE 15; below, on Planck's locus in the approximation of Kim et al.
    (US 7024034).
    """
    t = temperature_K
    if t >= 4000:
        low = (0.244063, 0.09911e3, 2.9678e6, -4.6070e9)
        high = (0.237040, 0.24748e3, 1.9018e6, -2.0064e9)
        a0, a1, a2, a3 = low if t <= 7000 else high
        x = a0 + a1 / t + a2 / t**2 + a3 / t**3
        y = -3.0 * x**2 + 2.870 * x - 0.275
    else:
        x = -0.2661239e9 / t**3 - 0.2343589e6 / t**2 + 0.8776956e3 / t + 0.179910
        if t >= 2222:
            y = -0.9549476 * x**3 - 1.37418593 * x**2 + 2.09137015 * x - 0.16748867
        else:
            y = -1.1063814 * x**3 - 1.34811020 * x**2 + 2.18555832 * x - 0.20219683
    rgb = np.clip(_XYZ_TO_RGB @ np.array([x / y, 1.0, (1 - x - y) / y]), 0.0, None)
    return triple(rgb / float(rgb @ LUMINANCE))


def as_measured(light: FloatImage, colour_filter: ColourFilter) -> FloatImage:
    """Return what a sensor measures of linear light (..., 3): three equal values if it is monochrome."""
    if colour_filter != "monochrome":
        return light
    return np.repeat((light @ PANCHROMATIC.astype(np.float32))[..., None], 3, axis=-1)


def scaled(rgb: RGB, factor: float) -> RGB:
    return rgb[0] * factor, rgb[1] * factor, rgb[2] * factor
