"""Images in the messages of a bag, as files of JPEG or PNG that are decoded later, in a child with limits.

The encodings are those of sensor_msgs/image_encodings
(https://docs.ros.org/en/noetic/api/sensor_msgs/html/image__encodings_8h.html).
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np

from symolo.core.files.image_headers import JPEG, PNG

RAW, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
QUALITY = 95
"""JPEG quality of images that are not JPEG files in the bag."""
_Convert = Callable[[np.ndarray], np.ndarray]
_ENCODINGS: Mapping[str, tuple[int, _Convert]] = MappingProxyType(
    {
        "bgr8": (3, np.asarray),
        "8UC3": (3, np.asarray),
        "rgb8": (3, lambda pixels: pixels[..., ::-1]),
        "bgra8": (4, lambda pixels: pixels[..., :3]),
        "rgba8": (4, lambda pixels: pixels[..., 2::-1]),
        "mono8": (1, lambda pixels: np.repeat(pixels, 3, axis=2)),
        "8UC1": (1, lambda pixels: np.repeat(pixels, 3, axis=2)),
        # OpenCV names a pattern by the second row and column, ROS by the first.
        "bayer_rggb8": (1, lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BayerBG2BGR)),
        "bayer_bggr8": (1, lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BayerRG2BGR)),
        "bayer_gbrg8": (1, lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BayerGR2BGR)),
        "bayer_grbg8": (1, lambda pixels: cv2.cvtColor(pixels, cv2.COLOR_BayerGB2BGR)),
    }
)
"""Channels of an encoding, and the function to blue, green and red (H, W, 3)."""


class UnknownImageError(Exception):
    """The images of a topic cannot be taken; the text says why."""


def image_file(message: Any, kind: str) -> bytes:  # noqa: ANN401 - its class is made at run time
    """Return the file of an image: that of a compressed message as it is, and a JPEG file of another one.

    Raises:
        UnknownImageError: It has a form that is not read.
    """
    if kind == COMPRESSED:
        data = bytes(message.data)
        if not data.startswith((JPEG, PNG)):
            raise UnknownImageError(f"its images have the format {message.format!r}, and neither JPEG nor PNG")
        return data
    if message.encoding not in _ENCODINGS:
        known = ", ".join(_ENCODINGS)
        raise UnknownImageError(f"its images have the encoding {message.encoding!r}; known are {known}")
    channels, convert = _ENCODINGS[message.encoding]
    shape, data = (message.height, message.width, channels), np.asarray(message.data, np.uint8)
    if not 0 < shape[1] * channels <= message.step or data.size < message.step * shape[0] or not shape[0]:
        raise UnknownImageError("its images have fewer bytes than their size needs")
    rows = data[: message.step * shape[0]].reshape(shape[0], message.step)[:, : shape[1] * channels]
    pixels = np.ascontiguousarray(convert(np.ascontiguousarray(rows).reshape(shape)))
    done, encoded = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not done:
        raise UnknownImageError("its images are too large for a JPEG file")
    return encoded.tobytes()
