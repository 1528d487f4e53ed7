"""Panoramas of the whole sphere, Radiance or OpenEXR, as linear light."""

import re

import cv2
import numpy as np

from configs.assets.decoding import decoded
from symolo.core.arrays import FloatImage
from symolo.core.files.exr import is_exr, read_exr
from symolo.core.files.image_decoder import LIGHT

MAX_BYTES = 256 << 20
MAX_PIXELS = 8192 * 4096
MAX_WIDTH_PX = 2048
"""Largest width after averaging down; panoramas are visible in reflections and behind the window only."""
MAX_COMPONENT = 1e9
"""Largest component, beyond any light on earth."""

_SUN = 20.0
"""Ratio to the median luminance above which components belong to a sun or a lamp, not to the sky."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear Rec. 709 components (ITU-R BT.709)."""
_RADIANCE = (b"#?RADIANCE", b"#?RGBE")
_FORMAT = b"\nFORMAT=32-bit_rle_rgbe\n"
_RESOLUTION = re.compile(rb"-Y ([0-9]{1,7}) \+X ([0-9]{1,7})\n")


def read_panorama(data: bytes) -> FloatImage:
    """Return linear Rec. 709 light (H, W, 3) of a file's bytes, zenith first; negative components become 0.

    Raises:
        ValueError: Neither Radiance nor OpenEXR, not the whole sphere, too large, cut short, damaged, or with
            components that are not numbers.
    """
    if data.startswith(_RADIANCE):
        light = _radiance(data)
    elif is_exr(data):
        channels = read_exr(data, _check_size, "RGB")
        light = np.stack([channels[name].astype(np.float32) for name in "RGB"], axis=-1)
    else:
        raise ValueError("is neither a Radiance (.hdr) nor an OpenEXR file")
    wrong = int(np.count_nonzero(~(np.abs(light) <= MAX_COMPONENT)))
    if wrong:
        raise ValueError(f"has {wrong} components that are not numbers up to {MAX_COMPONENT:g}")
    light = np.maximum(light, 0)
    if light.shape[1] > MAX_WIDTH_PX:
        light = cv2.resize(light, (MAX_WIDTH_PX, MAX_WIDTH_PX // 2), interpolation=cv2.INTER_AREA)
    if not light[: max(1, len(light) // 2)].any():
        raise ValueError("is black above the horizon")
    return np.ascontiguousarray(light, np.float32)


def mean_above(light: FloatImage) -> tuple[float, float, float]:
    """Return the mean colour of (H, W, 3) above the horizon by solid angle, without sun and lamps."""
    above = light[: max(1, len(light) // 2)].astype(np.float64)
    elevation = np.pi * (0.5 - (np.arange(len(above)) + 0.5) / len(light))
    # A sun or a lamp would dominate the mean; what is far brighter than the median is cut off.
    usual = float(np.median(above @ _LUMINANCE))
    sky = np.minimum(above, _SUN * usual) if usual > 0 else above
    red, green, blue = np.average(sky.mean(axis=1), axis=0, weights=np.cos(elevation)).tolist()
    return red, green, blue


def _radiance(data: bytes) -> FloatImage:
    """Read header lines, an empty one, the resolution, and pixels (https://radsite.lbl.gov/radiance/refer/filefmts.pdf)."""
    end = data.find(b"\n\n", 0, 1 << 16)
    match = _RESOLUTION.match(data, end + 2)
    if end < 0 or match is None or _FORMAT not in data[: end + 1]:
        raise ValueError("is not a Radiance file in RGB with the rows from top to bottom (-Y H +X W)")
    width, height = int(match[2]), int(match[1])
    _check_size(width, height)
    # OpenCV misreads some valid headers; replace the header by a plain one.
    plain = _RADIANCE[0] + _FORMAT + b"\n" + data[match.start() :]
    light = decoded(plain, LIGHT, (width, height))
    return np.asarray(light[..., ::-1], np.float32)


def _check_size(width: int, height: int) -> None:
    if width * height > MAX_PIXELS:
        raise ValueError(f"has {width} x {height} pixels; at most 8192 x 4096 can be read")
    if width != 2 * height or not height:
        raise ValueError(f"has {width} x {height} pixels; a panorama of the whole sphere is twice as wide as high")
