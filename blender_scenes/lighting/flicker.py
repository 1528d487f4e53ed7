"""Lamps on alternating current: the light of a frame relative to the mean over time."""

import numpy as np

from configs.schema.appearance.lighting import FlickerLook
from sensors.camera.colour import RGB
from symolo.core.arrays import Array
from symolo.core.random_streams import stream


def caught(flicker: FlickerLook, t_s: Array, exposure_s: float, phase_rad: float) -> Array:
    """Return (N,) the mean of 1 + depth cos(2 pi 2 f t + phase) over exposures centred on `t_s`.

    The mean of a cosine over T is the cosine at the middle times sin(x) / x of x = 2 pi f T.
    """
    cycles_hz = 2 * flicker.mains_hz
    swing = flicker.depth * np.sinc(cycles_hz * exposure_s)  # numpy's sinc(a) is sin(pi a) / (pi a)
    return 1.0 + swing * np.cos(2 * np.pi * cycles_hz * t_s + phase_rad)


def mains_phase_rad(seed: int) -> float:
    """Draw the phase of the lamps' light at the start of the run; its frequency is twice that of the mains."""
    return float(stream(seed, "mains phase").uniform(0.0, 2 * np.pi))


def frame_gains(  # noqa: PLR0917 - six separate quantities
    flicker: FlickerLook, t_s: Array, exposure_s: float, lamps: RGB, all_light: RGB, seed: int
) -> list[RGB]:
    """Return the gains of the three channels for each frame.

    Args:
        flicker: Depth and frequency.
        t_s: (N,) middles of the exposures.
        exposure_s: Length of each exposure; 0 for an instant.
        lamps: Light of the flickering lamps in the middle of the arena.
        all_light: All light there, that of the flickering lamps included.
        seed: Seed of the run.
    """
    share = np.divide(lamps, all_light, out=np.zeros(3), where=np.array(all_light) > 0)
    gains = 1.0 + share * (caught(flicker, t_s, exposure_s, mains_phase_rad(seed)) - 1.0)[:, None]
    return [(float(r), float(g), float(b)) for r, g, b in gains]
