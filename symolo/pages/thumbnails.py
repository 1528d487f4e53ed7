"""Images of a dataset, small enough for a page."""

import numpy as np

from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.reader.run_folder import Image

THUMBNAIL_PX = 320
"""Width of an image on a page, where it is not larger."""
_QUALITY = 85


def thumbnail(image: Image, max_width_px: int = THUMBNAIL_PX) -> bytes:
    """Return an image as JPEG, scaled down if it is wider than the page needs.

    Raises:
        InputError: It is missing or cannot be decoded.
    """
    import cv2  # noqa: PLC0415 - takes half a second, which readers of tables need not wait for

    pixels = image.pixels()
    height_px, width_px = pixels.shape[:2]
    if width_px <= max_width_px:
        return read_file(image.path, FileKind.IMAGE)
    size = (max_width_px, max(1, round(height_px * max_width_px / width_px)))
    small = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    encoded, jpeg = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not encoded:
        raise InputError("cannot be scaled down", where=str(image.path))
    return jpeg.tobytes()
