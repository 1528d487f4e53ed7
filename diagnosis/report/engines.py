"""Errors of the nominal and the extended robot in PyBullet, for a terminal and for the page."""

from collections.abc import Iterator

import numpy as np

from diagnosis.engine.base import PYBULLET
from diagnosis.engine.drive import DrivenPath
from diagnosis.engine.gain import EngineComparison
from diagnosis.report.sentences.quantities import gain_text


def in_lines(comparison: EngineComparison) -> Iterator[str]:
    """Yield a heading for each engine, and a line for each quantity."""
    if not comparison.engines:
        yield no_result(comparison)
        return
    for engine in comparison.engines:
        yield f"{engine_name(engine.engine)}: a gain of {gain_text(engine.whole)}"
        for error in engine.errors:
            change = f"{error.before:.3g} to {error.after:.3g} {error.unit}"
            yield f"  {error.quantity:20} {change:32} {gain_text(error.gain)}"
    yield f"The two engines differ by {differences(comparison)}."
    if comparison.path is not None:
        yield path_sentence(comparison.path)


def no_result(comparison: EngineComparison) -> str:
    return f"PyBullet gives no result: {comparison.why_not}."


def engine_name(engine: str) -> str:
    return "PyBullet" if engine == PYBULLET else "The twin with the same voltages"


def differences(comparison: EngineComparison) -> str:
    """Return how far the two engines are apart, such as `0.1 m in pose_dx_m`."""
    return ", ".join(f"{size:.2g} {unit} in {quantity}" for quantity, unit, size in comparison.apart)


def path_sentence(path: DrivenPath) -> str:
    """Return the mean distances of the simulated paths from the measured path, in a sentence."""
    before, after = (float(np.nanmean(path.off_m(poses))) for poses in (path.nominal, path.extended))
    return (
        f"Simulated for {path.t_s[-1] - path.t_s[0]:.0f} s from the voltages alone, the nominal robot is on average "
        f"{1e3 * before:.3g} mm away from the measured path, the extended robot {1e3 * after:.3g} mm."
    )
