"""Decoding of images that the user gives, in the child process that decodes untrusted images."""

import numpy as np
from numpy.typing import NDArray

from symolo.core.files.image_decoder import ImageFile, Undecodable, decode_images


def decoded(data: bytes, flags: int, size: tuple[int, int], *, is_strict: bool = False) -> NDArray[np.generic]:
    """Return an image (H, W, 3), blue first, as OpenCV decodes it.

    Args:
        data: The bytes of a file.
        flags: `COLOUR` or `LIGHT` of `image_decoder`.
        size: Width and height in the file's header; its EXIF orientation may exchange them.
        is_strict: Whether any message of the decoder refuses the file, since libjpeg decodes damaged data too.

    Raises:
        ValueError: It cannot be decoded, or not to that size.
    """
    (answer,) = decode_images([ImageFile(data, flags, size)])
    if isinstance(answer, Undecodable) or (is_strict and answer.has_message):
        raise ValueError("is cut short or damaged: its pixels cannot be decoded")
    return answer.pixels
