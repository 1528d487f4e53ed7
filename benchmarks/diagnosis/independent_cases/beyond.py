"""Disturbances that are larger than cases usually have, one kind at a time, as `--beyond` makes them.

They show how far the assumptions of a diagnosis may be wrong before its names are. Effects keep their likelihood ratios
in the worse noise, so that they are as visible as usual. Wider tolerances are not among them: an individual far outside
its tolerance is one with an effect, and a name for it would be right.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform
from benchmarks.diagnosis.independent_cases.setting import Setting

Worsen = Callable[[Setting, np.random.Generator], None]
"""Makes one disturbance of a drawn setting worse."""


def _wrong_noise(setting: Setting, rng: np.random.Generator) -> None:
    """Make the true noise 2.5 to 4 times as large or as small as stated; usually it is at most twice."""
    factor = {c: round(log_uniform(rng, 2.5, 4.0) ** draw_sign(rng), 3) for c in setting.plan.noise_factor}
    setting.plan = replace(setting.plan, noise_factor=factor)


def _many_outliers(setting: Setting, rng: np.random.Generator) -> None:
    """Make 8 to 15 % of the rows outliers; usually it is at most 6 %."""
    share = {c: round(rng.uniform(0.08, 0.15), 4) for c in setting.plan.outlier_share}
    setting.plan = replace(setting.plan, outlier_share=share)


def _correlated(setting: Setting, rng: np.random.Generator) -> None:
    """Give neighbours a correlation of 0.3 to 0.6; usually it is at most 0.2."""
    setting.plan = replace(setting.plan, lag1=round(rng.uniform(0.3, 0.6), 3))


def _heavy_tails(setting: Setting, rng: np.random.Generator) -> None:
    """Draw the noise from Student's t with 3 to 5 degrees of freedom; usually it is Gaussian."""
    setting.plan = replace(setting.plan, tail_degrees=int(rng.integers(3, 6)))


WORSE: Mapping[str, Worsen] = {
    "noise": _wrong_noise,
    "outliers": _many_outliers,
    "correlation": _correlated,
    "tails": _heavy_tails,
}
