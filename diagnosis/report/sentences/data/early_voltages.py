"""Sentences about voltages that changed between the rows of the log."""

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
    return (
        "The voltages of the log changed between its rows: on average, "
        f"{percent(early.mean)} of a change acted before the row that states it{scatter}. This is fitted with the "
        f"robot and is no part of it. {rows} of the motors may stay hidden. A log with every change of the voltages "
        "would show them."
    )


def in_json(early: EarlyPart | None) -> dict[str, object]:
    """Return the part of the voltages that acted early for answer.json; empty if they acted as logged."""
    return {"early_voltages": {"mean": early.mean, "sd": early.sd}} if early else {}
