"""Annotations as PNG files, the same bytes for the same pixels."""

import cv2
import numpy as np
from numpy.typing import NDArray

PngImage = NDArray[np.uint8] | NDArray[np.uint16]
"""(H, W), or (H, W, 3) with the channels red, green, blue."""

_COMPRESSION = 4
"""Level of zlib; higher ones take much more time for little less size."""


def encode_png(image: PngImage) -> bytes:
    """Return a PNG file of 8 or 16 bits per channel."""
    ordered = image if image.ndim == 2 else image[..., ::-1]  # OpenCV takes blue, green, red
    done, data = cv2.imencode(".png", np.ascontiguousarray(ordered), [cv2.IMWRITE_PNG_COMPRESSION, _COMPRESSION])
    if not done:
        raise OSError("OpenCV could not encode an annotation as PNG")
    return data.tobytes()
