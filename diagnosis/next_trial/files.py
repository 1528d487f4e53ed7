"""The files of a designed trial: instructions, the case to fill, inputs for a board, and what each model predicts."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict

import numpy as np
import yaml

from diagnosis.measured.case_files.case_format import DATA
from diagnosis.measured.case_files.nominal import NOMINAL, NominalSteady, NominalStep
from diagnosis.measured.case_files.write_case import csv_of
from diagnosis.measured.measurement import CaseKind, Trial
from diagnosis.next_trial.design import TrialDesign
from diagnosis.next_trial.drive_files import drive_files
from diagnosis.next_trial.template import to_fill
from diagnosis.next_trial.text import trial_text

INSTRUCTIONS, EXPECTED, PREDICTIONS, HEADER = "trial.md", "expected.json", "predictions.csv", "voltages.h"


def case_name(design: TrialDesign) -> str:
    """Return the name of the new case: `trial_1` after the first case, `trial_2` after two, and so on."""
    return f"trial_{max(len(design.diagnosis.measurement.cases), 1)}"


def trial_files(design: TrialDesign, command: str, simulation: str = "") -> Mapping[str, bytes]:
    """Return the contents by path inside the output folder; the same design gives the same bytes.

    Args:
        design: The trial.
        command: Command that diagnoses old and new data together.
        simulation: Command that simulates a drive.
    """
    folder = case_name(design)
    nominal = design.trial.nominal
    if nominal is None:
        raise ValueError("a designed trial has nominal parameters")
    is_drive = design.trial.kind is CaseKind.DRIVE_LOG
    texts = {
        INSTRUCTIONS: trial_text(design, command, simulation, folder),
        f"{folder}/{DATA}": csv_of(to_fill(design.trial) if is_drive else design.trial),
        f"{folder}/{NOMINAL}": yaml.safe_dump(nominal.model_dump(mode="json"), sort_keys=False),
        PREDICTIONS: "\n".join(_quantity_lines(design) if is_drive else _predictions(design)) + "\n",
        EXPECTED: json.dumps(as_json(design), indent=2, ensure_ascii=False) + "\n",
    }
    if isinstance(nominal, NominalSteady | NominalStep):
        texts[HEADER] = "\n".join(_header(design, nominal.motor.supply_voltage_V)) + "\n"
    contents = {name: text.encode() for name, text in texts.items()}
    return {**contents, **drive_files(design)} if is_drive else contents


def as_json(design: TrialDesign) -> dict[str, object]:
    """Return the models and what is expected, ready for JSON."""
    return {
        "models": [{"name": model.name, "weight": round(model.weight, 4)} for model in design.models],
        "one_right": _rounded(design.expected.one_right),
        "pairs": [_rounded_all(asdict(pair)) for pair in design.expected.pairs],
        "numbers": [_rounded_all(asdict(number)) for number in design.expected.numbers],
        "wider_limits": [_rounded_all(asdict(limit)) for limit in design.hindrances],
    }


def _rounded_all(values: Mapping[str, object]) -> dict[str, object]:
    return {key: _rounded(value) if isinstance(value, float) else value for key, value in values.items()}


def _rounded(value: float) -> float:
    """Return a number with five digits, which do not depend on the machine."""
    return float(f"{value:.5g}")


def _predictions(design: TrialDesign) -> Iterator[str]:
    """Yield a table with what each model predicts in each row."""
    observed = [c.name for c in design.trial.trials[0].channels if str(c.role) == "reading"]
    rows = design.trial.rows
    means = design.means.reshape(len(design.models), len(observed), rows)
    names = [f"{name} if {model.name}" for name in observed for model in design.models]
    yield ",".join(["trial", "t_s", *names])
    number = [trial.name for trial in design.trial.trials for _ in trial.t_s]
    t_s = np.concatenate([trial.t_s for trial in design.trial.trials])
    for k in range(rows):
        cells = [f"{means[m, q, k]:.6g}" for q in range(len(observed)) for m in range(len(design.models))]
        yield ",".join([number[k], f"{t_s[k]:.6g}", *cells])


def _quantity_lines(design: TrialDesign) -> Iterator[str]:
    """Yield a table with what each model predicts of each sample of a drive, whose quantities differ in their times."""
    yield ",".join(["quantity", "unit", "t_s", *(f"if {model.name}" for model in design.models)])
    for observed, means in zip(design.observed, np.split(design.means, design.ends[:-1], axis=1), strict=True):
        for k in np.flatnonzero(observed.usable).tolist():
            cells = [f"{value + 0.0:.6g}" for value in means[:, k].tolist()]
            yield ",".join([observed.name, observed.unit, f"{observed.t_s[k]:.6g}", *cells])


def _header(design: TrialDesign, supply_V: float) -> Iterator[str]:
    """Yield a C header with the voltages of each run, for the program of a board."""
    yield "/* Voltages of the trial: each is held for a number of milliseconds. A board with a supply of SUPPLY_MV"
    yield "   sets a duty cycle of millivolts / SUPPLY_MV; a negative voltage reverses the motor. Stop the motor, at 0,"
    yield "   between two runs until it is at rest. */"
    yield "#ifndef VOLTAGES_H"
    yield "#define VOLTAGES_H"
    yield "#include <stdint.h>"
    yield f"#define SUPPLY_MV {round(1000.0 * supply_V)}"
    yield f"#define RUNS {len(design.trial.trials)}"
    yield "typedef struct { uint32_t milliseconds; int16_t millivolts; } held_voltage;"
    for number, trial in enumerate(design.trial.trials, 1):
        held = _held(trial, is_steady=design.trial.kind is CaseKind.MOTOR_STEADY)
        yield f"static const held_voltage RUN_{number}[] = {{"
        yield from (f"  {{{milliseconds}, {millivolts}}}," for milliseconds, millivolts in held)
        yield "};"
    yield "#endif"


def _held(trial: Trial, *, is_steady: bool) -> Sequence[tuple[int, int]]:
    """Return durations [ms] and voltages [mV]; equal neighbours of a log are joined, those of a bench are rows."""
    ends = np.rint(1000.0 * trial.t_s).astype(int)
    durations = np.diff(ends, prepend=0)
    millivolts = np.rint(1000.0 * trial["u_cmd_V"].values).astype(int)
    joined: list[tuple[int, int]] = []
    for duration, value in zip(durations.tolist(), millivolts.tolist(), strict=True):
        if joined and joined[-1][1] == value and not is_steady:
            joined[-1] = (joined[-1][0] + duration, value)
        else:
            joined.append((duration, value))
    return joined
