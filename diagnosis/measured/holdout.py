"""Choice of the trials that are held out, by the names that the user gives.

A set of logs has no column `split`. Whole trials are held out and never single rows, because neighbouring rows share
noise, and the errors of a drive add up along it.
"""

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from diagnosis.measured.measurement import Measurement
from symolo.core.errors import InputError, nearest

EVERY = 3
"""One of so many trials is held out in a set that marks none."""


def hold_out(measurement: Measurement, patterns: Sequence[str]) -> Measurement:
    """Return the measurement with exactly those trials held out whose name or part matches a pattern.

    Args:
        measurement: The measurement; trials that it held out before are fitted unless they match as well.
        patterns: At least one pattern as for file names, with `*`, `?` and `[...]`, such as `circular/*`.

    Raises:
        InputError: A pattern matches no trial, or together they leave none to fit.
    """
    where = measurement.where
    names = [trial.name for trial in measurement.trials]
    labels = [(trial.name, trial.part) for trial in measurement.trials]
    for pattern in patterns:
        if not any(fnmatchcase(label, pattern) for both in labels for label in both if label):
            allowed = f"{names[0]} to {names[-1]}" if len(names) > 1 else names[0]
            what = "no trial to hold out has such a name"
            raise InputError(what, where=where, got=pattern, allowed=allowed, nearest=nearest(pattern, names))
    held = [any(fnmatchcase(label, p) for p in patterns for label in both if label) for both in labels]
    if all(held):
        raise InputError("all trials would be held out", where=where, cure="leave some of them to fit")
    trials = tuple(
        replace(trial, holdout=np.full(len(trial.t_s), is_held))
        for trial, is_held in zip(measurement.trials, held, strict=True)
    )
    return replace(measurement, trials=trials)


def select_part(measurement: Measurement, part: str) -> Measurement:
    """Return the measurement with the trials of one part of the robot, such as `left wheel`.

    The two motors of a robot are two measurements of a motor.

    Raises:
        InputError: There is no such part.
    """
    trials = tuple(trial for trial in measurement.trials if trial.part == part)
    if not trials:
        parts = list(dict.fromkeys(trial.part for trial in measurement.trials if trial.part))
        where = measurement.where
        what = "no trial is of that part"
        raise InputError(what, where=where, got=part, allowed=", ".join(parts) or "none", nearest=nearest(part, parts))
    return replace(measurement, name=f"{measurement.name}-{part.replace(' ', '-')}", trials=trials)
