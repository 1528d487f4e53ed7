"""Sentences about the error at the end of whole runs of a drive, predicted from the counts alone."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.whole_runs import PARTS, WholeRuns, fitted_to_whole_runs
from diagnosis.measured.case_files.nominal import KnownWheels
from diagnosis.measured.measurement import Measurement
from diagnosis.report.sentences.quantities import with_error


def run_ends(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield sentences for a drive with known wheels, if whole runs show more than short windows."""
    measurement, fit = diagnosis.measurement, diagnosis.fit
    if not isinstance(measurement.nominal, KnownWheels):
        return
    whole = fitted_to_whole_runs(measurement, fit.hypothesis, fit.x, diagnosis.candidates.testable)
    heldout = tuple(trial for trial in measurement.trials if trial.holdout.all() and len(trial.t_s) > PARTS)
    if whole is None or not heldout:
        return
    runs = replace(measurement, trials=heldout)
    yield (
        "If the last pose of a held-out run is predicted from the first one and the counts alone, its error is "
        f"{_error(runs, diagnosis.nominal)} with the nominal robot and {_error(runs, diagnosis.extended)} with the "
        f"extended one (rms of {len(heldout)} runs)."
    )
    more = [effect for effect in whole.hypothesis.effects if effect not in fit.hypothesis.effects]
    for effect in more:
        values, std = whole.hypothesis.values(effect, whole.x), whole.std(effect)
        parameters = ", ".join(f"{name} {with_error(value, std[name], '+-')}" for name, value in values.items())
        yield f"Whole runs need {effect.name} in addition: {parameters}."
    if more:
        yield f"With it, the error of the last pose would be {_error(runs, whole.robot)}."


def _error(runs: Measurement, robot: RobotConfig) -> str:
    """Return the root mean square error of place and heading at the end."""
    end = WholeRuns(runs, robot).errors(robot)[:, -1]
    place_m, heading_rad = np.sqrt(np.mean(np.sum(end[:, :2] ** 2, axis=1))), np.sqrt(np.mean(end[:, 2] ** 2))
    return f"{1e3 * place_m:.3g} mm and {1e3 * heading_rad:.3g} mrad"
