"""Which trials of a measurement are held out: what the source marks, or what the user of a set names.

A set of logs has no column `split`. Whole trials are held out, never rows of one: neighbours share noise, and a drive's
errors add up along it.
"""

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from diagnosis.measured.measurement import Measurement
from symolo.core.errors import InputError, nearest

EVERY = 3
"""Of the trials of a set that marks none, one in so many is held out."""


def hold_out(measurement: Measurement, patterns: Sequence[str]) -> Measurement:
    """The measurement with exactly those trials held out whose name or part matches a pattern, such as `circular/*`.

    Args:
        measurement: Whatever it held out before is no longer.
        patterns: As file names have them: `*`, `?` and `[...]`; at least one.

    Raises:
        InputError: A pattern matches no trial, or together they leave none to fit.
    """
    where = next(iter(measurement.source.files), measurement.name)
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


def of_part(measurement: Measurement, part: str) -> Measurement:
    """The trials of one part of the robot alone, such as `left wheel`: two motors are two measurements of a motor.

    Raises:
        InputError: There is no such part.
    """
    trials = tuple(trial for trial in measurement.trials if trial.part == part)
    if not trials:
        parts = list(dict.fromkeys(trial.part for trial in measurement.trials if trial.part))
        where = next(iter(measurement.source.files), measurement.name)
        what = "no trial is of that part"
        raise InputError(what, where=where, got=part, allowed=", ".join(parts) or "none", nearest=nearest(part, parts))
    return replace(measurement, name=f"{measurement.name}-{part.replace(' ', '-')}", trials=trials)
