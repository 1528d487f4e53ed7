"""Images of a dataset: only here, the bytes of an image from a stranger reach a decoder."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from symolo.core.files.image_decoder import AS_STORED, COLOUR, DecodedImage, ImageFile, decode_images
from symolo.core.files.image_headers import image_size
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE

MAX_PIXELS = 8192 * 8192
"""Largest number of pixels of an image that can be rendered."""
_MAX_BATCH = 64
_BATCH_PIXELS = 1_000_000
_BATCH_BYTES = 8_000_000
"""Images are decoded together until they have so many files, pixels or bytes."""


def decoded(path: Path, size: tuple[int, int] | None = None) -> np.ndarray | None:
    """Return the image (H, W) or (H, W, 3) in OpenCV's channel order and the type of the file; None if not an image.

    Args:
        path: The file.
        size: Width and height [px] that the image must have, if they are known.
    """
    return next(decoded_files([path], size))


def decoded_files(paths: Iterable[Path], size: tuple[int, int] | None = None) -> Iterator[np.ndarray | None]:
    """Yield each image as `decoded` returns it, which takes less time than one after the other."""
    return decoded_contents(map(_content, paths), size=size)


def decoded_bytes(data: bytes, *, in_colour: bool = False) -> np.ndarray | None:
    """Return the image in a file; None if it is not a complete PNG or JPEG, or takes too long to decode.

    Args:
        data: Content of the file.
        in_colour: Whether to return (H, W, 3) of 8 bits whatever is stored, blue first.

    Raises:
        MemoryError: The machine lacks the memory for it.
        EnvironmentLacking: The child process that decodes images cannot be started.
    """
    return next(decoded_contents([data], in_colour=in_colour))


def decoded_contents(
    contents: Iterable[bytes | None], *, in_colour: bool = False, size: tuple[int, int] | None = None
) -> Iterator[np.ndarray | None]:
    """Yield each image as `decoded_bytes` returns it; several contents are taken at a time.

    Args:
        contents: Contents of files; None yields None. An error that they raise comes after what was before it.
        in_colour: As for `decoded_bytes`.
        size: Width and height [px] that an image must have. One whose header announces other ones is not decoded: the
            largest that is allowed would take a second or two.
    """
    left, error = iter(contents), None
    while error is None:
        batch: list[ImageFile | None] = []
        pixels = count = 0
        try:
            while len(batch) < _MAX_BATCH and pixels < _BATCH_PIXELS and count < _BATCH_BYTES:
                image = _image_file(next(left), size, in_colour=in_colour)
                batch.append(image)
                if image is not None:
                    pixels, count = pixels + image.size[0] * image.size[1], count + len(image.data)
        except Exception as raised:  # noqa: BLE001 - StopIteration too
            error = raised
        yield from _decoded_batch(batch)
    if not isinstance(error, StopIteration):
        raise error


def _content(path: Path) -> bytes | None:
    try:
        return read_file(path, FileKind.IMAGE)
    except NOT_THERE:
        return None


def _image_file(data: bytes | None, size: tuple[int, int] | None, *, in_colour: bool) -> ImageFile | None:
    if data is None:
        return None
    try:
        announced = image_size(data, MAX_PIXELS)
    except ValueError:
        return None
    return ImageFile(data, COLOUR if in_colour else AS_STORED, announced) if size in {None, announced} else None


def _decoded_batch(batch: list[ImageFile | None]) -> Iterator[np.ndarray | None]:
    answers = iter(decode_images(images) if (images := [image for image in batch if image is not None]) else ())
    for image in batch:
        answer = None if image is None else next(answers)
        yield answer.pixels if isinstance(answer, DecodedImage) else None
