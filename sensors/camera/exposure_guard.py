"""Whether pictures show something: how much of each is black or burnt, and what to say where it is too much."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from symolo.dataset.brightness import BLACK_UP_TO, BURNT_FROM, MAX_BLACK, MAX_BURNT

ALL = 0.99

_CURES = {
    "black": "raise look.camera.compensation_ev or brightness, bring look.camera.exposure_adaption nearer to 1, or give"
    " the look more light (lamps.flux_klm, sky.luminance_kcd_m2)",
    "burnt": "lower look.camera.compensation_ev, brightness or contrast, or bring look.camera.exposure_adaption nearer"
    " to 1",
}


@dataclass(frozen=True)
class Extremes:
    """Shares of a picture's pixels, 0 to 1."""

    black: float
    burnt: float

    @classmethod
    def of(cls, jpeg: bytes) -> "Extremes":
        """Of an encoded picture.

        Raises:
            ValueError: It cannot be decoded.
        """
        grey = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
        if grey is None:
            raise ValueError("the picture cannot be decoded")
        return cls(float(np.mean(grey <= BLACK_UP_TO)), float(np.mean(grey >= BURNT_FROM)))


def exposure_warnings(pictures: Mapping[str, Extremes]) -> tuple[str, ...]:
    """One line for black and one for burnt pictures of a run, by file name; none where all are well."""
    black = {name: found.black for name, found in pictures.items()}
    burnt = {name: found.burnt for name, found in pictures.items()}
    return (*_warning("black", black, MAX_BLACK), *_warning("burnt", burnt, MAX_BURNT))


def _warning(what: str, shares: Mapping[str, float], most: float) -> Iterator[str]:
    worst = max(shares, key=lambda name: shares[name])
    beyond = sum(share > most for share in shares.values())
    if beyond:
        yield (
            f"{beyond} of {len(shares)} images are {what} in more than {most:.0%} of their pixels, the worst, {worst},"
            f" in {shares[worst]:.0%}: {_CURES[what]}"
        )


def all_black(pictures: Sequence[Extremes]) -> str:
    """Why the pictures of a run are no use: nothing can be seen in any of them; empty where in one something can."""
    if any(found.black < ALL for found in pictures):
        return ""
    return f"all {len(pictures)} images are black: {_CURES['black']}"
