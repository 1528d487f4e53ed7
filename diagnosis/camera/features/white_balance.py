"""Gains of red and blue, as measured, as the temperature for which the simulated camera is balanced."""

import numpy as np
from scipy.optimize import minimize_scalar

from sensors.camera.colour import light_rgb

LOWEST_K, HIGHEST_K = 1500.0, 15000.0
"""Of look.camera.white_balance_K."""
MIN_SD = 0.02
"""Of a gain's logarithm: cameras of one kind differ by as much, and what is fitted is no surer of a temperature."""
FURTHEST = 3.0
"""Standard deviations from the gains of a temperature, up to which they are those of one."""


def temperature_of(red: float, blue: float, red_sd: float = 0.0, blue_sd: float = 0.0) -> float | None:
    """Temperature [K] of the light that these gains, beside green, render neutral; None where there is none.

    Args:
        red: Gain over that of green.
        blue: Likewise.
        red_sd: Relative standard error.
        blue_sd: Likewise.
    """
    wanted, sd = np.log([red, blue]), np.maximum([red_sd, blue_sd], MIN_SD)

    def apart(log_K: float) -> float:
        light = light_rgb(float(np.exp(log_K)))
        if min(light) <= 0.0:
            return np.inf
        return float(np.max(np.abs(np.log([light[1] / light[0], light[1] / light[2]]) - wanted) / sd))

    starts = np.linspace(np.log(LOWEST_K), np.log(HIGHEST_K), 60)
    best = int(np.argmin([apart(float(start)) for start in starts]))
    bounds = (starts[max(best - 1, 0)], starts[min(best + 1, len(starts) - 1)])
    found = minimize_scalar(apart, bounds=bounds, method="bounded", options={"xatol": 1e-5})
    return float(np.exp(found.x)) if apart(float(found.x)) <= FURTHEST else None
