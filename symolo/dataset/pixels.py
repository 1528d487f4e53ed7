"""Images of a dataset: only here, the bytes of an image from a stranger reach a decoder."""

from pathlib import Path

import numpy as np

from symolo.core.files.image_headers import image_size
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE

MAX_PIXELS = 8192 * 8192
"""Largest number of pixels of an image that can be rendered."""


def decoded(path: Path, size: tuple[int, int] | None = None) -> np.ndarray | None:
    """Return the image (H, W) or (H, W, 3) in OpenCV's channel order and the type of the file; None if not an image.

    Args:
        path: The file.
        size: Width and height [px] that the image must have, if they are known.
    """
    try:
        return decoded_bytes(read_file(path, FileKind.IMAGE), size=size)
    except NOT_THERE:
        return None


def decoded_bytes(data: bytes, *, in_colour: bool = False, size: tuple[int, int] | None = None) -> np.ndarray | None:
    """Return the image in a file; None if it is not a complete PNG or JPEG, or takes too long to decode.

    Args:
        data: Content of the file.
        in_colour: Whether to return (H, W, 3) of 8 bits whatever is stored, blue first.
        size: Width and height [px] that the image must have. One whose header announces other ones is not decoded: the
            largest that is allowed would take a second or two.
    """
    import cv2  # noqa: PLC0415 - half a second that whoever reads tables does not need

    try:
        announced = image_size(data, MAX_PIXELS)
        if size not in {None, announced}:
            return None
        flags = cv2.IMREAD_COLOR if in_colour else cv2.IMREAD_UNCHANGED
        return cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except (ValueError, cv2.error):
        return None
