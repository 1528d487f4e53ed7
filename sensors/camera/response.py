"""The camera's response from light to pixels, in numpy and OpenCV.

The steps are those of a camera: blur, focus, glare and vignetting of the lens; exposure; shot and read noise of the
sensor; gains of the white balance, which amplify that noise; behind a Bayer filter, the limit of what a pixel can
measure, and the interpolation of colours; saturation of colours; tone curve; noise reduction; sharpening; JPEG.

Pixels depend on the light, the settings and the number of the frame, but never on threads or order.
"""

from dataclasses import dataclass
from typing import Annotated, Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from configs.schema.appearance.camera_look import CameraLook, ColourFilter
from sensors.camera.colour import LUMINANCE, RGB, as_measured, light_rgb
from sensors.camera.metering import automatic_gain
from sensors.camera.mosaic import colours, demosaiced, mosaic
from sensors.camera.optics import blurred, defocused, integrated_over_pixel, with_veiling_glare
from sensors.camera.post_processing import denoised, sharpened
from symolo.core.arrays import FloatImage
from symolo.core.left_out import equals
from symolo.core.random_streams import stream

_MIN_SHARE = 0.02
"""Minimum share of a component in the light of the white balance, which keeps gains below 50. Light of 1900 K has no
blue."""
_KNEE = 0.6
"""Value above which the tone curve is flatter than that of sRGB, to keep detail in the highlights."""
_WHITE = 254.6 / 255
"""Value of the tone curve that certainly becomes the grey value 255, into which values from 254.5 are rounded."""


@dataclass(frozen=True)
class CameraResponse:
    """The response of a camera: from light on the sensor to the pixels of a JPEG file."""

    seed: int
    brightness: float
    """Linear pixel value of the median luminance, including exposure compensation."""
    exposure_adaption: float
    white_balance: RGB
    """Gains of the channels; that of green is 1."""
    contrast: float
    saturation: float
    vignetting: float
    shot_noise: float
    read_noise: float
    jpeg_quality: int
    lens_blur_px: float
    veiling_glare: float
    sharpening: float
    sharpening_radius_px: float
    # A value without effect is left out of the JSON text, so that jobs without these steps have the bytes of before.
    defocus_px: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    pixel_px: Annotated[float, Field(exclude_if=equals(1.0))] = 1.0
    colour_filter: Annotated[ColourFilter, Field(exclude_if=equals("none"))] = "none"
    noise_reduction: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    colour_blur_px: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    shading_right_ev: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    shading_down_ev: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    manual_gain: Annotated[float, Field(exclude_if=equals(0.0))] = 0.0
    """Linear pixel value of a luminance of 1 kcd/m2 with manual exposure; 0 is automatic exposure."""

    @classmethod
    def from_look(
        cls, look: CameraLook, light: RGB, seed: int, jpeg_quality: int, width_px: int = 0
    ) -> "CameraResponse":
        """Return the response of a camera.

        Args:
            look: Settings of the camera.
            light: Colour of the light; its brightness does not matter.
            seed: Seed of the noise.
            jpeg_quality: Quality of the JPEG files.
            width_px: Width of the image; a camera in focus needs none.
        """
        return cls(
            seed=seed,
            brightness=look.brightness * 2.0**look.compensation_ev,
            exposure_adaption=look.exposure_adaption,
            white_balance=_white_balance(look, light),
            contrast=look.contrast,
            saturation=look.saturation,
            vignetting=look.vignetting,
            shot_noise=look.shot_noise * _gain(look) ** 0.5,
            read_noise=look.read_noise * _gain(look),
            jpeg_quality=jpeg_quality,
            lens_blur_px=look.lens_blur_px,
            veiling_glare=look.veiling_glare,
            sharpening=look.sharpening,
            sharpening_radius_px=look.sharpening_radius_px,
            defocus_px=look.defocus_share * width_px,
            pixel_px=look.pixel_px,
            colour_filter=look.colour_filter,
            noise_reduction=look.noise_reduction,
            colour_blur_px=look.colour_blur_px,
            shading_right_ev=look.shading_right_ev,
            shading_down_ev=look.shading_down_ev,
            manual_gain=_manual_gain(look),
        )


def _white_balance(look: CameraLook, light: RGB) -> RGB:
    """Return gains between those for `white_balance_K` and those that make `light` neutral, mixed on a log scale.

    A monochrome sensor has none.
    """
    if look.colour_filter == "monochrome":
        return 1.0, 1.0, 1.0
    fixed = np.maximum(light_rgb(look.white_balance_K), _MIN_SHARE)
    actual = np.maximum(light, _MIN_SHARE * max(light)) if max(light) > 0 else fixed
    share = look.white_balance_adaption
    white = (fixed / fixed[1]) ** (1 - share) * (actual / actual[1]) ** share
    return 1.0 / float(white[0]), 1.0, 1.0 / float(white[2])


def _gain(look: CameraLook) -> float:
    """Return the gain of the sensor, relative to that for which its noise is set; 1 if the exposure is automatic.

    Without gain, N electrons fill a pixel and are white. With a gain g, N / g electrons are white: the standard
    deviation of photons, sqrt(N / g), is then sqrt(g) times as large a share of white, and that of r electrons of read
    noise g times (the linear model of EMVA 1288, in which both pass the same gain).
    """
    return 1.0 if look.manual_exposure is None else look.manual_exposure.iso / look.manual_exposure.base_iso


def _manual_gain(look: CameraLook) -> float:
    """Return the linear pixel value of a luminance of 1 kcd/m2 with manual exposure; 0 if the exposure is automatic.

    A sensor of ISO speed S saturates at an exposure of 78 / S lx s (ISO 12232). A lens of f-number N gives an area of
    luminance L the illuminance 0.65 L / N^2 in the image.
    """
    if look.manual_exposure is None:
        return 0.0
    exposure_kilo = 1000.0 * 0.65 * look.exposure_time_s / look.manual_exposure.f_number**2
    return exposure_kilo * look.manual_exposure.iso / 78.0 * 2.0**look.compensation_ev


def white_level(metered: float, response: CameraResponse) -> float:
    """Return the luminance that the exposure of a run renders white; `metered` is the median of the run."""
    return 1.0 / response.manual_gain if response.manual_gain else metered / response.brightness


def _run_gain(metered: float, response: CameraResponse) -> float:
    """Return the linear pixel value of a unit of light with the exposure of a run."""
    return response.manual_gain or response.brightness / metered


def develop(
    light: FloatImage,
    response: CameraResponse,
    metered: float,
    number: int,
    field: NDArray[np.bool_] | None = None,
) -> NDArray[np.uint8]:
    """Return the 8-bit RGB image (H, W, 3) of linear light (H, W, 3).

    Automatic exposure follows the median of the frame and `metered`, the median of the run. It never makes more than a
    small share of the frame brighter than white.

    Args:
        light: Linear light.
        response: Response of the camera.
        metered: Median of the run.
        number: Number of the frame.
        field: (H, W), pixels that the lens brings light to, on which the exposure depends; None for all.
    """
    height, width, _ = light.shape
    light = _through_glass(light, response)
    gain = response.manual_gain or automatic_gain(
        light if field is None else light[field], metered, response.brightness, response.exposure_adaption
    )
    raw = light * np.float32(gain) * _transmitted(width, height, response)[..., None]
    return (_grey_values(_balanced(raw, response, number), response) + 0.5).astype(np.uint8)


def develop_part(light: FloatImage, response: CameraResponse, metered: float, number: int | None) -> FloatImage:
    """Return the grey values (H, W, 3), 0 to 255 without rounding, of linear light (H, W, 3) from a part of an image.

    It has the exposure of the run, and neither vignetting nor shading. With a `number` it has the noise of the sensor.
    """
    raw = _through_glass(light, response) * np.float32(_run_gain(metered, response))
    return _grey_values(_balanced(raw, response, number), response)


def _balanced(raw: FloatImage, response: CameraResponse, number: int | None) -> FloatImage:
    """Return the values (H, W, 3) of the sensor after white balance, without noise if `number` is None."""
    gains = np.asarray(response.white_balance, np.float32)
    if response.colour_filter == "none":
        return (raw if number is None else np.maximum(raw + _noise(raw, response, number), 0)) * gains
    is_monochrome = response.colour_filter == "monochrome"
    sensor = raw[..., 0] if is_monochrome else mosaic(raw)
    if number is not None:
        draw = stream(response.seed, "camera noise", number).standard_normal(sensor.shape, np.float32)
        sensor = np.maximum(sensor + _noise_sd(sensor, response) * draw, 0)
    # A pixel holds what becomes white under the smallest gain. The other gains bring it beyond white, where a camera
    # cuts it off, so that saturated areas have no colour. Both limits together are this one. It acts before the
    # interpolation, whose weights are partly negative: light far beyond white would make its neighbours black.
    white = np.float32(inverse_tone(np.array([_WHITE]), response.contrast)[0])
    if is_monochrome:
        return np.repeat(np.minimum(sensor, white)[..., None], 3, axis=2)
    return np.clip(demosaiced(np.minimum(sensor * gains[colours(*sensor.shape)], white)), 0, white)


def _grey_values(exposed: FloatImage, response: CameraResponse) -> FloatImage:
    """Return grey values, 0 to 255, of balanced light: saturation, tone curve, noise reduction, sharpening."""
    grey = (exposed @ LUMINANCE.astype(np.float32))[..., None]
    exposed = np.maximum(grey + response.saturation * (exposed - grey), 0)
    coded = denoised(tone(exposed, response.contrast), response.noise_reduction, response.colour_blur_px)
    return 255 * sharpened(coded, response.sharpening, response.sharpening_radius_px)


def encode_jpeg(pixels: NDArray[np.uint8], quality: int) -> bytes:
    """Return RGB pixels as a JPEG file."""
    done, data = cv2.imencode(".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise OSError("OpenCV could not encode a frame as JPEG")
    return data.tobytes()


def compressed(pixels: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """Return RGB pixels (H, W, 3) as they are after compression as JPEG."""
    data = np.frombuffer(encode_jpeg(pixels, quality), np.uint8)
    return np.asarray(cv2.cvtColor(cv2.imdecode(data, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB), np.uint8)


def _through_glass(light: FloatImage, response: CameraResponse) -> FloatImage:
    light = as_measured(light, response.colour_filter)
    light = defocused(blurred(light, response.lens_blur_px), response.defocus_px)
    return with_veiling_glare(integrated_over_pixel(light, response.pixel_px), response.veiling_glare)


def _transmitted(width: int, height: int, response: CameraResponse) -> FloatImage:
    """Return the share of light (H, W) that arrives: 1 in the middle, 1 - `vignetting` in the corners, with shading.

    The loss is quadratic in the distance from the middle. Shading is an even slope of the logarithm of the light.
    """
    x = np.arange(width, dtype=np.float32)[None, :]
    y = np.arange(height, dtype=np.float32)[:, None]
    share = 1 - response.vignetting * corner_share(x, y, width, height)
    right, down = response.shading_right_ev, response.shading_down_ev
    if right or down:
        share = share * 2.0 ** (right * ((x + 0.5) / width - 0.5) + down * ((y + 0.5) / height - 0.5))
    return share.astype(np.float32)


def corner_share(u: NDArray[Any], v: NDArray[Any], width: int, height: int) -> NDArray[Any]:
    """Return the squared distance of pixels from the middle of the image, 1 in its corners."""
    x = (u + 0.5) / width - 0.5
    y = ((v + 0.5) - 0.5 * height) / width
    return (x**2 + y**2) / (0.25 + 0.25 * (height / width) ** 2)


def _noise(raw: FloatImage, response: CameraResponse, number: int) -> FloatImage:
    """Return shot and read noise of the sensor, slightly blurred like that of an interpolated colour filter."""
    draw = stream(response.seed, "camera noise", number).standard_normal(raw.shape, np.float32)
    soft = cv2.GaussianBlur(draw, (3, 3), 0.6)
    return (2.0 * _noise_sd(raw, response) * soft).astype(np.float32)  # the blur has halved the standard deviation


def _noise_sd(raw: FloatImage, response: CameraResponse) -> FloatImage:
    # Shot noise is Poisson: its variance is proportional to the light. Read noise is constant; variances add.
    return np.sqrt(response.shot_noise**2 * np.maximum(raw, 0) + response.read_noise**2)


def tone(linear: FloatImage, contrast: float) -> FloatImage:
    """Apply contrast about middle grey, a soft shoulder, and the transfer function of sRGB (IEC 61966-2-1)."""
    scaled = 0.18 * (linear / 0.18) ** np.float32(contrast)
    over = scaled - np.float32(_KNEE)
    rolled = np.where(over > 0, 1 - (1 - _KNEE) * np.exp(-over / (1 - _KNEE)), scaled)
    return np.where(rolled <= 0.0031308, 12.92 * rolled, 1.055 * np.power(rolled, 1 / 2.4) - 0.055)


def inverse_tone(coded: NDArray[np.float64], contrast: float) -> NDArray[np.float64]:
    """Return the light whose `tone` are these values, 0 to 1; just below white the result is inaccurate."""
    low = coded / 12.92
    rolled = np.where(coded <= 0.04045, low, ((np.maximum(coded, 0.0) + 0.055) / 1.055) ** 2.4)
    over = np.minimum((rolled - _KNEE) / (1 - _KNEE), 1.0 - 1e-6)
    scaled = np.where(over > 0, _KNEE - (1 - _KNEE) * np.log1p(-over), rolled)
    return 0.18 * (np.maximum(scaled, 0.0) / 0.18) ** (1.0 / contrast)
