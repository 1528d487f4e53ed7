"""Panoramas of the whole sphere, Radiance or OpenEXR, as linear light."""

import re

import cv2
import numpy as np
from numpy.typing import NDArray

from configs.assets.quiet import decoded
from symolo.core.exr import is_exr, read_exr

MAX_BYTES = 256 << 20
MAX_PIXELS = 8192 * 4096
WIDEST_PX = 2048
"""A wider panorama is averaged down to it: it is seen in mirrors and behind the window."""
LARGEST = 1e9
"""Of a component; more is no light that anything on earth has."""

_SUN = 20.0
"""Components above so many times the median luminance belong to a sun or a lamp, not to the sky."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear Rec. 709 components (ITU-R BT.709)."""
_RADIANCE = (b"#?RADIANCE", b"#?RGBE")
_FORMAT = b"\nFORMAT=32-bit_rle_rgbe\n"
_RESOLUTION = re.compile(rb"-Y ([0-9]{1,7}) \+X ([0-9]{1,7})\n")

Light = NDArray[np.float32]


def read_panorama(data: bytes) -> Light:
    """(H, W, 3) linear Rec. 709 light of a file's bytes, the zenith first; what is below 0 counts as 0.

    Raises:
        ValueError: Neither Radiance nor OpenEXR, not all of the sphere, too large, cut short, damaged, or with
            components that are no number.
    """
    if data.startswith(_RADIANCE):
        light = _radiance(data)
    elif is_exr(data):
        light = _open_exr(data)
    else:
        raise ValueError("is neither a Radiance (.hdr) nor an OpenEXR file")
    wrong = int(np.count_nonzero(~(np.abs(light) <= LARGEST)))
    if wrong:
        raise ValueError(f"has {wrong} components that are no number up to {LARGEST:g}")
    light = np.maximum(light, 0)
    if light.shape[1] > WIDEST_PX:
        light = cv2.resize(light, (WIDEST_PX, WIDEST_PX // 2), interpolation=cv2.INTER_AREA)
    if not light[: max(1, len(light) // 2)].any():
        raise ValueError("is black above the horizon")
    return np.ascontiguousarray(light, np.float32)


def mean_above(light: Light) -> tuple[float, float, float]:
    """Mean colour of (H, W, 3) above the horizon by solid angle, without its sun and lamps."""
    above = light[: max(1, len(light) // 2)].astype(np.float64)
    elevation = np.pi * (0.5 - (np.arange(len(above)) + 0.5) / len(light))
    usual = float(np.median(above @ _LUMINANCE))
    kept = np.minimum(above, _SUN * usual) if usual > 0 else above
    red, green, blue = np.average(kept.mean(axis=1), axis=0, weights=np.cos(elevation)).tolist()
    return red, green, blue


def _radiance(data: bytes) -> Light:
    """Header lines, one that is empty, the resolution, pixels (https://radsite.lbl.gov/radiance/refer/filefmts.pdf)."""
    end = data.find(b"\n\n", 0, 1 << 16)
    found = _RESOLUTION.match(data, end + 2)
    if end < 0 or found is None or _FORMAT not in data[: end + 1]:
        raise ValueError("is not a Radiance file in RGB with the rows from top to bottom (-Y H +X W)")
    width, height = int(found[2]), int(found[1])
    _check_size(width, height)
    # OpenCV reads other headers than it should, and refuses some that it need not: it is given one of ours.
    plain = _RADIANCE[0] + _FORMAT + b"\n" + data[found.start() :]
    light = decoded(plain, cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR, (width, height))
    return np.asarray(light[..., ::-1], np.float32)


def _open_exr(data: bytes) -> Light:
    channels = read_exr(data, _check_size, "RGB")
    return np.stack([channels[name].astype(np.float32) for name in "RGB"], axis=-1)


def _check_size(width: int, height: int) -> None:
    if width * height > MAX_PIXELS:
        raise ValueError(f"has {width} x {height} pixels; at most 8192 x 4096 can be read")
    if width != 2 * height or not height:
        raise ValueError(f"has {width} x {height} pixels; a panorama of the whole sphere is twice as wide as high")
