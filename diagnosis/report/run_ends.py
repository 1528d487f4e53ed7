"""How far from the truth a drive's runs end by the counts alone: before, after, and with what whole runs ask for."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.whole_runs import PARTS, WholeRuns, fitted_to_whole_runs
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import KnownWheels
from diagnosis.report.quantities import with_error


def run_ends(diagnosis: Diagnosis) -> Iterator[str]:
    """Sentences about a drive whose wheels are known and whose runs say more than their windows; else none."""
    measurement, fit = diagnosis.measurement, diagnosis.fit
    if not isinstance(measurement.nominal, KnownWheels):
        return
    whole = fitted_to_whole_runs(measurement, fit.hypothesis, fit.x, diagnosis.candidates.testable)
    held = tuple(trial for trial in measurement.trials if trial.holdout.all() and len(trial.t_s) > PARTS)
    if whole is None or not held:
        return
    runs = replace(measurement, trials=held)
    yield (
        f"Predicted from its first pose and the counts alone, a run held out ends {_off(runs, diagnosis.nominal)} off "
        f"by the nominal robot, {_off(runs, diagnosis.extended)} by the extended one (rms of {len(held)} runs)."
    )
    more = [effect for effect in whole.hypothesis.effects if effect not in fit.hypothesis.effects]
    for effect in more:
        values, std = whole.hypothesis.values(effect, whole.x), whole.std(effect)
        told = ", ".join(f"{name} {with_error(value, std[name], '+-')}" for name, value in values.items())
        yield f"Whole runs ask for {effect.name} besides: {told}."
    if more:
        yield f"With it a run held out would end {_off(runs, whole.robot)} off."


def _off(runs: Measurement, robot: RobotConfig) -> str:
    """Root mean square of place and heading at the end."""
    end = WholeRuns(runs, robot).errors(robot)[:, -1]
    place_m, heading_rad = np.sqrt(np.mean(np.sum(end[:, :2] ** 2, axis=1))), np.sqrt(np.mean(end[:, 2] ** 2))
    return f"{1e3 * place_m:.3g} mm and {1e3 * heading_rad:.3g} mrad"
