"""Reading of a file of the user, and its description in a specification."""

import hashlib
from pathlib import Path

from configs.assets import images, panoramas
from configs.assets.refusal import Refusal
from configs.schema.appearance.asset import Asset, AssetKind

_CURES = {
    "image": "save it again as PNG or JPEG",
    "panorama": "save it again as Radiance .hdr or as OpenEXR with ZIP compression",
}


def read_asset(kind: AssetKind, name: str, place: Path) -> Asset:
    """Return the description of a file.

    Raises:
        Refusal: It cannot be read, or is not of its kind.
    """
    try:
        data = read_bytes(place, images.MAX_BYTES if kind == "image" else panoramas.MAX_BYTES)
        (height_px, width_px, _), mean = _image(data) if kind == "image" else _panorama(data)
    except ValueError as error:
        raise Refusal(str(error), cure=_CURES[kind]) from None
    except MemoryError:
        raise Refusal("does not fit into the memory that is free", cure="save it smaller") from None
    red, green, blue = (float(f"{component:.6g}") for component in mean)  # the same on every machine
    sha256 = hashlib.sha256(data).hexdigest()
    return Asset(name=name, sha256=sha256, width_px=width_px, height_px=height_px, mean_rgb=(red, green, blue))


_ShapeAndMean = tuple[tuple[int, ...], tuple[float, float, float]]
"""Shape (H, W, 3) and mean colour."""


def _image(data: bytes) -> _ShapeAndMean:
    """Return the shape before averaging down, since rounding to whole pixels would change the height in metres."""
    image = images.whole_image(data)
    return image.shape, images.mean_of(images.averaged_down(image))


def _panorama(data: bytes) -> _ShapeAndMean:
    light = panoramas.read_panorama(data)
    return light.shape, panoramas.mean_above(light)


def read_bytes(place: Path, max_bytes: int) -> bytes:
    try:
        with place.open("rb") as file:
            data = file.read(max_bytes + 1)
    except OSError as error:
        raise Refusal(f"cannot be read: {error.strerror}") from None
    if len(data) > max_bytes:
        raise Refusal(f"is larger than {max_bytes >> 20} MiB", cure="save it smaller")
    return data
