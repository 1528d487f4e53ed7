import numpy as np

from diagnosis.inference.bases import bases
from diagnosis.stages.base import Covariate, Shape

STEPS = (3.0, -5.0, 2.0, -4.0, 6.0, -2.0)


def explained(covariate, values):
    """Greatest share of the squares that one basis takes."""
    rows = np.ones(len(values), dtype=bool)
    shares = []
    for basis in bases(covariate, rows):
        left = values - basis.columns @ np.linalg.lstsq(basis.columns, values, rcond=None)[0]
        shares.append(1.0 - float(left @ left) / float(values @ values))
    return max(shares)


def test_ringing_after_steps_either_way_is_found_by_the_time_since_and_the_size_of_the_step():
    """An oscillation of 20 Hz that decays in 60 ms, as large as the step and of its sign."""
    since_s = np.tile(0.002 * np.arange(1, 301), len(STEPS))
    size = np.repeat(STEPS, 300)
    ringing = size * np.exp(-since_s / 0.06) * np.sin(2.0 * np.pi * 20.0 * since_s)
    assert explained(Covariate("time_since_step_s", since_s, Shape.SINCE, size=size), ringing) > 0.7
    assert explained(Covariate("time_since_step_s", since_s), ringing) < 0.2


def test_a_wave_along_few_rows():
    x = np.random.default_rng(1).permutation(np.linspace(0.04, 1.0, 40))
    assert explained(Covariate("distance_m", x), np.sin(2.0 * np.pi * x / 0.1)) > 0.7
