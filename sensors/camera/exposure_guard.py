"""Shares of black and overexposed (burnt) pixels of images, and the warnings if these shares are too large."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import cv2
import numpy as np

from symolo.dataset.brightness import BLACK_UP_TO, BURNT_FROM, MAX_BLACK, MAX_BURNT

ALL = 0.99
NOWHERE: Mapping[str, str] = MappingProxyType({})

_CURES = {
    "black": "raise look.camera.compensation_ev or brightness, bring look.camera.exposure_adaption nearer to 1 (with"
    " manual exposure: raise exposure_time_s or iso), or give the look more light (lamps.flux_klm,"
    " sky.luminance_kcd_m2)",
    "burnt": "lower look.camera.compensation_ev, brightness or contrast, or bring look.camera.exposure_adaption nearer"
    " to 1 (with manual exposure: lower exposure_time_s or iso)",
}


@dataclass(frozen=True)
class Extremes:
    """Shares of an image's pixels, 0 to 1."""

    black: float
    burnt: float

    @classmethod
    def from_jpeg(cls, jpeg: bytes) -> "Extremes":
        """Return the shares of an encoded image.

        Raises:
            ValueError: The image cannot be decoded.
        """
        grey = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
        if grey is None:
            raise ValueError("the image cannot be decoded")
        return cls(float(np.mean(grey <= BLACK_UP_TO)), float(np.mean(grey >= BURNT_FROM)))


def exposure_warnings(images: Mapping[str, Extremes], inside: Mapping[str, str] = NOWHERE) -> tuple[str, ...]:
    """Return a line about the black images of a run and one about the overexposed ones, if there are any.

    Args:
        images: The shares of each image, by file name.
        inside: Wall or obstacle that the camera is inside of, by the names of the images that are taken there.
    """
    black = {name: shares.black for name, shares in images.items()}
    burnt = {name: shares.burnt for name, shares in images.items()}
    lit = {name: 0.0 if name in inside else share for name, share in black.items()}
    hidden = {name: share for name, share in black.items() if name in inside}
    return (
        *_warning("black", hidden, MAX_BLACK, len(images), _inside(inside)),
        *_warning("black", lit, MAX_BLACK, len(images), _CURES["black"]),
        *_warning("burnt", burnt, MAX_BURNT, len(images), _CURES["burnt"]),
    )


def _warning(what: str, shares: Mapping[str, float], max_share: float, number: int, cure: str) -> Iterator[str]:
    beyond = sum(share > max_share for share in shares.values())
    if beyond:
        worst = max(shares, key=lambda name: shares[name])
        yield (
            f"{beyond} of {number} images are {what} in more than {max_share:.0%} of their pixels,"
            f" the worst, {worst}, in {shares[worst]:.0%}: {cure}"
        )


def _inside(inside: Mapping[str, str]) -> str:
    return f"the camera is inside {', '.join(dict.fromkeys(inside.values()))} there"


def all_black(images: Mapping[str, Extremes], inside: Mapping[str, str] = NOWHERE) -> str:
    """Return a message if all images of a run are black; empty if something is visible in one of them.

    The arguments are those of `exposure_warnings`.
    """
    if any(shares.black < ALL for shares in images.values()):
        return ""
    return f"all {len(images)} images are black: {_inside(inside) if set(images) <= set(inside) else _CURES['black']}"
