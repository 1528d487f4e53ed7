"""Annotations as PNG files, the same bytes for the same picture."""

import cv2
import numpy as np
from numpy.typing import NDArray

PngImage = NDArray[np.uint8] | NDArray[np.uint16]
"""(H, W), or (H, W, 3) with its channels in the order of the file: red, green, blue."""

_COMPRESSION = 4
"""Of zlib's levels, the last whose gain in size is worth its time."""


def encode_png(picture: PngImage) -> bytes:
    """PNG file of 8 or 16 bits a channel."""
    ordered = picture if picture.ndim == 2 else picture[..., ::-1]  # OpenCV takes blue, green, red
    done, data = cv2.imencode(".png", np.ascontiguousarray(ordered), [cv2.IMWRITE_PNG_COMPRESSION, _COMPRESSION])
    if not done:
        raise OSError("OpenCV could not encode an annotation as PNG")
    return data.tobytes()
