"""Gains of red and blue, as measured, as the temperature for which the simulated camera is balanced."""

import numpy as np
from scipy.optimize import minimize_scalar

from sensors.camera.colour import light_rgb

LOWEST_K, HIGHEST_K = 1500.0, 15000.0
"""Bounds of look.camera.white_balance_K."""
MIN_SD = 0.02
"""Smallest standard deviation of the logarithm of a gain; cameras of one kind differ by as much."""
FURTHEST = 3.0
"""Largest distance of the gains from those of the nearest temperature, in standard deviations."""


def temperature_of(red: float, blue: float, red_sd: float = 0.0, blue_sd: float = 0.0) -> float | None:
    """Return the temperature [K] of the light that these gains render neutral; None where there is none.

    Args:
        red: Gain over that of green.
        blue: Gain over that of green.
        red_sd: Relative standard error of the red gain.
        blue_sd: Relative standard error of the blue gain.
    """
    log_gains, sd = np.log([red, blue]), np.maximum([red_sd, blue_sd], MIN_SD)

    def apart(log_K: float) -> float:
        light = light_rgb(float(np.exp(log_K)))
        if min(light) <= 0.0:
            return np.inf
        return float(np.max(np.abs(np.log([light[1] / light[0], light[1] / light[2]]) - log_gains) / sd))

    starts = np.linspace(np.log(LOWEST_K), np.log(HIGHEST_K), 60)
    best = int(np.argmin([apart(float(start)) for start in starts]))
    bounds = (starts[max(best - 1, 0)], starts[min(best + 1, len(starts) - 1)])
    minimum = minimize_scalar(apart, bounds=bounds, method="bounded", options={"xatol": 1e-5})
    return float(np.exp(minimum.x)) if apart(float(minimum.x)) <= FURTHEST else None
