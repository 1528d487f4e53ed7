"""Sentences about voltages that changed between the rows of the log."""

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.early_voltages import EarlyPart
from diagnosis.report.sentences.quantities import percent


def early_voltage_sentences(diagnosis: Diagnosis) -> str:
    """Return how the voltages changed between the rows and what that means for the names; empty if they did not."""
    early = diagnosis.early_voltages
    if early is None:
        return ""
    scatter = f", and this part varies by {percent(early.sd)} from change to change" if early.sd > 0.0 else ""
    rows = "Rows after a change are less certain for it, so that effects" if early.sd > 0.0 else "Effects"
    steps = np.concatenate([np.diff(trial.t_s) for trial in diagnosis.measurement.trials])
    time_ms = 1e3 * max(early.mean, early.sd) * float(np.median(steps))
    return (
        "The voltages act as if they changed between the rows of the log: on average, "
        f"{percent(early.mean)} of a change acted before the row that states it{scatter}. Times of the rows that are "
        f"wrong by about {time_ms:.2g} ms look the same. This is fitted with the robot and is no part of it. {rows} of "
        "the motors may stay hidden. A log with every change of the voltages would show them, or one with exact times, "
        "if only these are wrong."
    )


def in_json(early: EarlyPart | None) -> dict[str, object]:
    """Return the part of the voltages that acted early for answer.json; empty if they acted as logged."""
    return {"early_voltages": {"mean": early.mean, "sd": early.sd}} if early else {}
