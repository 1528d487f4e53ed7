"""Images that differ from the others of their release; successive ones form a group."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.brightness import MAX_BLACK, MAX_BURNT
from symolo.report.statistics.image_statistics import ImageNumbers

MAX_Z = 3.5
"""Modified z-score of an outlier, at least (Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993)."""
_NORMAL_MAD = 0.6745
"""Median absolute deviation of normal noise, in standard deviations."""
_MIN_SHARPNESS = 1e-3


@dataclass(frozen=True)
class OutlierGroup:
    """Successive images of a run that are outliers."""

    run: str
    numbers: tuple[int, ...]
    worst: int
    """Number of the image that differs most."""
    why: str
    """Properties in which the image `worst` differs."""
    score: float
    """Deviation of the image `worst`; an image is an outlier above 1."""

    @property
    def extent(self) -> str:
        """Which images the group has, in words."""
        return "this image only" if len(self.numbers) == 1 else f"also images {self.numbers[0]} to {self.numbers[-1]}"


def outliers(runs: Sequence[ImageNumbers]) -> tuple[OutlierGroup, ...]:
    """Return the groups of outliers, the most different first.

    Brightness and sharpness are compared with all images, clipping with fixed shares.
    """
    brightness = modified_z(np.concatenate([run.brightness for run in runs]))
    # Logarithms, so that an image that is twice as sharp differs as much as one that is half as sharp.
    sharpness = modified_z(np.log(np.maximum(np.concatenate([run.sharpness for run in runs]), _MIN_SHARPNESS)))
    groups, first = [], 0
    for run in runs:
        end = first + len(run.numbers)
        groups += _groups(run, brightness[first:end], sharpness[first:end])
        first = end
    # Rounded, so that equal scores keep the order of the runs on every machine.
    return tuple(sorted(groups, key=lambda group: -round(group.score, 6)))


def _groups(run: ImageNumbers, brightness: Array, sharpness: Array) -> list[OutlierGroup]:
    scores = np.array(
        [np.abs(brightness) / MAX_Z, np.abs(sharpness) / MAX_Z, run.black / MAX_BLACK, run.burnt / MAX_BURNT]
    )
    worst = scores.max(axis=0)
    out = np.flatnonzero(worst > 1.0)
    groups = []
    for members in np.split(out, np.flatnonzero(np.diff(out) > 1) + 1) if len(out) else []:
        at = int(members[np.argmax(worst[members])])
        words = (
            f"mean grey {run.brightness[at]:.0f}, {'dark' if brightness[at] < 0 else 'bright'}",
            f"sharpness {run.sharpness[at]:.1f}, {'little' if sharpness[at] < 0 else 'much'} detail",
            f"{run.black[at]:.0%} black",
            f"{run.burnt[at]:.0%} overexposed",
        )
        why = ", ".join(text for text, score in zip(words, scores[:, at], strict=True) if score > 1.0)
        numbers = tuple(run.numbers[i] for i in members.tolist())
        groups.append(OutlierGroup(run.run, numbers, run.numbers[at], why, float(worst[at])))
    return groups


def modified_z(values: Array) -> Array:
    """Return the distance from the median in robust standard deviations, (N,); 0 where the median deviation is 0."""
    deviations = values - np.median(values)
    mad = float(np.median(np.abs(deviations)))
    return _NORMAL_MAD * deviations / mad if mad > 0 else np.zeros_like(values)
