"""The response of a camera, from the light on its sensor to the numbers in the image."""

from typing import Literal

from pydantic import Field

from configs.schema.base import Section, Slug, absent
from symolo.core.left_out import equals

ColourFilter = Literal["none", "bayer", "monochrome"]


BASE_ISO = 100.0
"""Usual ISO speed without gain."""


class ManualExposure(Section):
    """Manual exposure, which is the same in all images of all runs; its time is `exposure_time_s`.

    White light of a luminance of L cd/m2 has the linear value L t S / (120 N^2), with the time t, the speed S and the
    f-number N; white is 1.
    """

    iso: float = Field(ge=1, le=1_000_000)
    """ISO speed S, the gain of the sensor: ISO 200 is twice as bright as ISO 100, with more noise."""
    base_iso: float = Field(default=BASE_ISO, ge=1, le=1_000_000, exclude_if=equals(BASE_ISO))
    """ISO speed without gain, at which white fills a pixel: `shot_noise` and `read_noise` are those at this speed."""
    f_number: float = Field(default=2.8, ge=0.5, le=64)
    """F-number N of the lens, its focal length over its aperture: f/2.8 is 2.8. It affects only the brightness."""


class CameraLook(Section):
    """Camera response, from the light on the sensor to the numbers in the image."""

    name: Slug | None = Field(default_factory=absent, exclude_if=lambda name: name is None)
    """Name of the camera, if it has a file of its own."""
    description: str = Field(default="", exclude_if=lambda text: not text)
    """Description for people."""
    brightness: float = Field(default=0.25, ge=0.01, le=0.9)
    """Linear value to which the exposure brings the median luminance; 0.18 is a photographer's middle grey."""
    compensation_ev: float = Field(default=0.0, ge=-6, le=6)
    """Exposure compensation in stops; +1 doubles the light."""
    exposure_adaption: float = Field(default=0.5, ge=0, le=1)
    """Adaption of the exposure: 0 is one exposure per run, metered on a few of its views; 1 meters each frame."""
    exposure_time_s: float = Field(default=0.0, ge=0, le=0.1)
    """Exposure time of each pixel, which causes motion blur and averages flicker; 0 is an instant. Brightness depends
    on it only with `manual_exposure`."""
    manual_exposure: ManualExposure | None = Field(default=None, exclude_if=lambda exposure: exposure is None)
    """Manual exposure, in place of the automatic one with `brightness` and `exposure_adaption`."""
    white_balance_K: float = Field(default=5000.0, ge=1500, le=15000)
    """Colour temperature that is rendered neutral without automatic white balance."""
    white_balance_adaption: float = Field(default=0.8, ge=0, le=1)
    """Adaption of the white balance: 0 uses `white_balance_K`; 1 renders the mixed light over the arena neutral."""
    contrast: float = Field(default=1.15, ge=0.5, le=2)
    """Slope of the tone curve around its middle; 1 leaves the contrast unchanged."""
    saturation: float = Field(default=1.1, ge=0, le=2)
    """Factor on the saturation of colours; 0 is grey."""
    vignetting: float = Field(default=0.25, ge=0, le=1)
    """Share of light that is lost in the corners."""
    shading_right_ev: float = Field(default=0.0, ge=-3, le=3, exclude_if=equals(0.0))
    """Stops by which the right border of every image is lighter than its left border, as by a lamp on the robot or by a
    lens that is not in the middle of the sensor; 0 is even."""
    shading_down_ev: float = Field(default=0.0, ge=-3, le=3, exclude_if=equals(0.0))
    """Stops by which the lower border is lighter than the upper one, likewise."""
    lens_blur_px: float = Field(default=0.0, ge=0, le=5)
    """Standard deviation of the lens' point spread; a cheap lens has 0.5 to 1 at 160 x 120."""
    defocus_share: float = Field(default=0.0, ge=0, le=0.05, exclude_if=equals(0.0))
    """Diameter of the even disc that a point out of focus becomes, as a share of the image's width; 0 is in focus."""
    pixel_px: float = Field(default=1.0, ge=1, le=8, exclude_if=equals(1.0))
    """Width of the square over which a pixel gathers light; 1 is the pixel itself, 2 an image that the camera has
    enlarged from half as many pixels."""
    veiling_glare: float = Field(default=0.0, ge=0, le=0.3)
    """Share of the light that the lens spreads evenly over the image, which raises the black level."""
    colour_filter: ColourFilter = Field(default="none", exclude_if=equals("none"))
    """Colours that the sensor measures: `none` measures all three at each pixel; `bayer` has a filter that lets one of
    them through, and interpolates the others; `monochrome` measures all light together, so that images are grey."""
    shot_noise: float = Field(default=0.012, ge=0, le=0.5)
    """Standard deviation at full white, proportional to the root of the light."""
    read_noise: float = Field(default=0.003, ge=0, le=0.5)
    """Standard deviation of the noise in the dark, relative to full white."""
    noise_reduction: float = Field(default=0.0, ge=0, le=0.5, exclude_if=equals(0.0))
    """Contrast of what the camera smooths away: standard deviation along lines of five pixels, relative to full white,
    of which it keeps half; 0 is no noise reduction."""
    colour_blur_px: float = Field(default=0.0, ge=0, le=20, exclude_if=equals(0.0))
    """Standard deviation of the blur of colours, which takes the colour from noise; 0 is none."""
    sharpening: float = Field(default=0.0, ge=0, le=3)
    """Strength of an unsharp mask; 0 is none."""
    sharpening_radius_px: float = Field(default=1.0, ge=0.3, le=10)
    """Standard deviation of the blur of the unsharp mask."""
