"""Images unlike the others of their release, by name; those that follow each other are told as one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.brightness import MAX_BLACK, MAX_BURNT
from symolo.report.statistics.image_statistics import ImageNumbers

FAR = 3.5
"""Modified z-score from which a value is an outlier (Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993)."""
_OF_NORMAL = 0.6745
"""Median absolute deviation of normal noise, in its standard deviations."""
_MIN_SHARPNESS = 1e-3


@dataclass(frozen=True)
class Outlier:
    """Images of a run, each next to the one before."""

    run: str
    numbers: tuple[int, ...]
    worst: int
    """Number of the one that is farthest out."""
    why: str
    """Of that one."""
    score: float
    """How far out that one is; from 1 on it is an outlier."""


def outliers(of_runs: Sequence[ImageNumbers]) -> tuple[Outlier, ...]:
    """The farthest out first. Brightness and sharpness are held against all images, clipping against fixed shares."""
    brightness = modified_z(np.concatenate([of.brightness for of in of_runs]))
    # Ratios: twice as sharp is as far out as half as sharp.
    sharpness = modified_z(np.log(np.maximum(np.concatenate([of.sharpness for of in of_runs]), _MIN_SHARPNESS)))
    found, first = [], 0
    for of in of_runs:
        end = first + len(of.numbers)
        found += _of_run(of, brightness[first:end], sharpness[first:end])
        first = end
    return tuple(sorted(found, key=lambda one: -round(one.score, 6)))


def _of_run(of: ImageNumbers, brightness: Array, sharpness: Array) -> list[Outlier]:
    scores = np.array([np.abs(brightness) / FAR, np.abs(sharpness) / FAR, of.black / MAX_BLACK, of.burnt / MAX_BURNT])
    worst = scores.max(axis=0)
    out = np.flatnonzero(worst > 1.0)
    found = []
    for group in np.split(out, np.flatnonzero(np.diff(out) > 1) + 1) if len(out) else []:
        at = int(group[np.argmax(worst[group])])
        words = (
            f"mean grey {of.brightness[at]:.0f}, {'dark' if brightness[at] < 0 else 'bright'}",
            f"sharpness {of.sharpness[at]:.1f}, {'little' if sharpness[at] < 0 else 'much'} detail",
            f"{of.black[at]:.0%} black",
            f"{of.burnt[at]:.0%} burnt",
        )
        why = ", ".join(text for text, score in zip(words, scores[:, at], strict=True) if score > 1.0)
        numbers = tuple(of.numbers[i] for i in group.tolist())
        found.append(Outlier(of.run, numbers, of.numbers[at], why, float(worst[at])))
    return found


def modified_z(values: Array) -> Array:
    """Distance from the median in standard deviations, as the median distance tells them, (N,); 0 where that is 0."""
    apart = values - np.median(values)
    spread = float(np.median(np.abs(apart)))
    return _OF_NORMAL * apart / spread if spread > 0 else np.zeros_like(values)
