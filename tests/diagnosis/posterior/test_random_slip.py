"""The random slip of wheels, estimated from headings that were made with a known slip."""

import numpy as np
import pytest

from diagnosis.posterior.random_slip import HeadingChanges, slip_of_headings

TRACK_M = 0.2
ROW_M = 0.002


def trials(slip_m_sqrt_m, noise_rad, count=60, length_m=4.0, seed=3):
    """Headings every 2 mm: both wheels slip independently at each row, and each logged heading has noise."""
    rng = np.random.Generator(np.random.PCG64(seed))
    way_m = ROW_M * np.arange(round(length_m / ROW_M) + 1)
    for number in range(count):
        slips_m = slip_m_sqrt_m * np.sqrt(ROW_M) * rng.standard_normal((len(way_m) - 1, 2))
        error = np.concatenate([[0.0], np.cumsum(slips_m[:, 0] - slips_m[:, 1]) / TRACK_M])
        error += noise_rad * rng.standard_normal(len(way_m))
        marks = np.arange(500, len(way_m), 500)
        yield HeadingChanges(
            f"trial_{number}",
            error[10::10] - error[:-10:10],
            np.full(len(way_m) // 10, 10 * ROW_M),
            error[marks] - error[0],
            way_m[marks],
        )


@pytest.mark.parametrize(("slip", "noise"), [(1.6e-3, 3e-3), (5e-4, 1e-3), (5e-3, 0.0)])
def test_the_slip_comes_back_with_its_standard_error(slip, noise):
    estimate = slip_of_headings(list(trials(slip, noise)), TRACK_M)
    # 60 trials whose four marks are correlated: between 60 and 240 independent squares.
    assert 0.5 / np.sqrt(240) < estimate.sd_log < 1.5 / np.sqrt(120)
    assert abs(np.log(estimate.slip_m_sqrt_m / slip)) < 3.0 * estimate.sd_log


def test_headings_without_slip_or_too_few_of_them_show_none():
    assert slip_of_headings(list(trials(0.0, 3e-3)), TRACK_M) is None
    assert slip_of_headings(list(trials(1.6e-3, 3e-3, count=3)), TRACK_M) is None
    assert slip_of_headings([], TRACK_M) is None
