"""How much better the extended camera predicts pictures that nothing was fitted to."""

from dataclasses import dataclass

import numpy as np

from diagnosis.camera.case import Mask
from diagnosis.camera.fit import Model
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

KEPT = 0.97
"""Of the samples: the rest are mistaken edges and reflections."""
DRAWS = 400


@dataclass(frozen=True)
class PictureGain:
    before: float
    """Error of the nominal camera, in the samples' unit: root mean square without the largest 3 %."""
    after: float
    value: float
    """1 - after / before."""
    low: float
    high: float
    """95 % of bootstrap draws of whole pictures lie between."""


def picture_gain(model: Model, heldout: Mask, x: Array) -> PictureGain | None:
    """Of deviations x (P,) over none, on samples (N,) held out; None without any."""
    before, after = model.left(np.zeros_like(x)), model.left(x)
    known = heldout & np.isfinite(before) & np.isfinite(after)
    parts = [(before[here], after[here]) for f in np.unique(model.frame) if (here := known & (model.frame == f)).any()]
    if len(parts) < 2:
        return None
    rng = stream(0, "bootstrap")
    draws = [_gain([parts[i] for i in rng.integers(0, len(parts), len(parts))])[2] for _ in range(DRAWS)]
    low, high = np.quantile(draws, [0.025, 0.975]).tolist()
    was, is_now, value = _gain(parts)
    return PictureGain(was, is_now, value, low, high)


def _gain(parts: list[tuple[Array, Array]]) -> tuple[float, float, float]:
    was, is_now = (_trimmed(np.concatenate([part[k] for part in parts])) for k in (0, 1))
    return was, is_now, 1.0 - is_now / max(was, 1e-12)


def _trimmed(left: Array) -> float:
    size = np.sort(np.abs(left))
    kept = size[: max(1, int(KEPT * len(size)))]
    return float(np.sqrt(np.mean(kept**2)))
