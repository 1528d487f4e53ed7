"""The pattern of all validation experiments: tables, checks, panels of a figure, and notes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.panels import Panel
from symolo.core.files.file_hashes import canonical_json

Table = Mapping[str, Any]
"""Columns and single figures by name, with the unit at the end of the name; NaN where there is no value.

A column is an array (N,); a single figure is a number or a text.
"""


@dataclass(frozen=True)
class ValidationCheck:
    """One figure of an experiment beside the figure that theory or a publication expects."""

    name: str
    value: float
    """Figure that the simulation gives, in `unit`; NaN if it gives none."""
    expected: float
    """Figure that is expected, in `unit`."""
    tolerance: float | None
    """Largest allowed difference from `expected`; None if nothing is required of this robot."""
    source: str
    """Source of the expected figure."""
    unit: str = ""
    detail: str = ""
    """Further figures for the reader."""
    is_open: bool = False
    """Whether too little was measured for a verdict."""

    @property
    def passed(self) -> bool | None:
        """Return whether the figure is within the tolerance; None without a verdict."""
        if self.is_open or self.tolerance is None:
            return None
        return abs(self.value - self.expected) <= self.tolerance

    def line(self) -> str:
        """Return the check as one line of a report."""
        verdict = "open" if self.is_open else {None: "note", True: "holds", False: "MISSED"}[self.passed]
        unit = f" {self.unit}" if self.unit else ""
        allowed = f" +- {self.tolerance:.3g}" if self.tolerance else ""
        detail = f"; {self.detail}" if self.detail else ""
        return (
            f"{verdict:8}{self.name}: {self.value:.5g}{unit}, expected {self.expected:.5g}{allowed}{unit} "
            f"({self.source}){detail}"
        )


@dataclass(frozen=True)
class ExperimentResult:
    """Result of one experiment with one robot."""

    tables: Mapping[str, Table]
    checks: Sequence[ValidationCheck] = ()
    panels: Sequence[Panel] = ()
    notes: Sequence[str] = ()
    """Sentences on results for which no figure is expected."""

    def check(self, name: str) -> ValidationCheck:
        """Return the check of this name."""
        return next(check for check in self.checks if check.name == name)

    def lines(self) -> list[str]:
        """Return checks and notes for a terminal, one line each."""
        return [*(check.line() for check in self.checks), *(f"note    {note}" for note in self.notes)]


@dataclass(frozen=True)
class Experiment:
    """One experiment with a part of a robot."""

    name: str
    shows: str
    """Sentence on what a reader learns from it."""
    run: Callable[[RobotConfig, int], ExperimentResult]
    """Function of the robot and of the seed for everything that is drawn."""


@dataclass(frozen=True)
class ValidatedPart:
    """A part of the robot with its experiments."""

    name: str
    experiments: Sequence[Experiment]
    require: Callable[[RobotConfig], None]
    """Function that raises InputError for a robot with which the experiments cannot be done."""


def result_json(part: str, robot: RobotConfig, seed: int, results: Mapping[Experiment, ExperimentResult]) -> bytes:
    """Return all figures of the experiments with a part as JSON; the same figures give the same bytes."""
    experiments = {
        experiment.name: {
            "shows": experiment.shows,
            "tables": result.tables,
            "checks": [vars(check) | {"passed": check.passed} for check in result.checks],
            "notes": list(result.notes),
        }
        for experiment, result in results.items()
    }
    described = robot.model_dump(mode="json", exclude_none=True)
    return canonical_json(_plain({"part": part, "seed": seed, "robot": described, "experiments": experiments}))


def _plain(value: object) -> object:
    """Return the value with lists for arrays and None for NaN, as JSON has neither."""
    if isinstance(value, Mapping):
        return {str(name): _plain(inner) for name, inner in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return None if isinstance(value, float) and np.isnan(value) else value
