"""Rows of a range bench: distance, material, angle and light of each reading."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalTof
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.next_trial.library.base import Library, Units
from diagnosis.next_trial.library.rows import library_of_rows
from diagnosis.next_trial.limits import Limits
from diagnosis.next_trial.template import trial_with
from symolo.core.arrays import Array

DISTANCES = 13
ORDER = ("material", "incidence_rad", "ambient_lux", "distance_m")
"""Inputs by which the rows are sorted: those that are changed with most effort come first."""


def tof_bench(template: Measurement, limits: Limits, robots: Sequence[RobotConfig]) -> Library:
    """Return the rows for the limits, with the listed materials; other inputs have values of the old data."""
    del robots
    near_m, far_m = limits.distances_m
    conditions = list(
        product(
            _materials(template),
            _values(template, "incidence_rad"),
            _values(template, "ambient_lux"),
            np.round(np.geomspace(max(near_m, 1e-3), far_m, DISTANCES), 3).tolist(),
        )
    )
    columns = {
        name: np.array([condition[k] for condition in conditions], dtype=float)
        for k, name in enumerate(ORDER)
        if name != "material"
    }
    materials = np.array([condition[0] for condition in conditions])
    t_s = limits.row_s * np.arange(1.0, limits.units + 1.0)
    temperature = _values(template, "temperature_C")[0]

    def trial(name: str, chosen: Units) -> Trial:
        inputs = {key: values[chosen] for key, values in columns.items()}
        inputs["temperature_C"] = np.full(len(chosen), temperature)
        return trial_with(template, name, t_s.copy(), inputs, words={"material": materials[chosen].tolist()})

    def order(chosen: Units) -> Units:
        keys = [columns["distance_m"], columns["ambient_lux"], columns["incidence_rad"], _codes(materials)]
        return chosen[np.lexsort([key[chosen] for key in keys])]

    return library_of_rows(template, len(conditions), t_s, trial, order)


def _materials(template: Measurement) -> list[str]:
    """Return the materials that nominal.yaml lists, and those of the old data."""
    labels = [trial.label("material").values for trial in template.trials]
    known = template.nominal.tof.reflectance if isinstance(template.nominal, NominalTof) else {}
    return list(dict.fromkeys([*known, *(word for words in labels for word in words)]))


def _values(template: Measurement, name: str) -> list[float]:
    """Return the usual, smallest and largest values of an input of the old data; NaN if it was not logged."""
    values = np.concatenate([channel.values for channel in template.across(name)])
    known = values[np.isfinite(values)]
    if not len(known):
        return [np.nan]
    return list(dict.fromkeys(np.round([np.median(known), known.min(), known.max()], 4).tolist()))


def _codes(words: Array) -> Array:
    return np.unique(words, return_inverse=True)[1].astype(float)
