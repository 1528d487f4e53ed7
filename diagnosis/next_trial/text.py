"""The next trial in words: what to set, what to log, and what to expect."""

from collections.abc import Iterator, Sequence
from textwrap import wrap

import numpy as np

from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.next_trial.design import WEAK, TrialDesign
from diagnosis.next_trial.drive_files import COMMANDS, planned_path, start_text
from diagnosis.next_trial.expectation import ExpectedNumber
from diagnosis.next_trial.library.drive_log import expected_paths, floor_text
from diagnosis.next_trial.models import robots_of
from diagnosis.report.sentences.quantities import listed
from diagnosis.report.sentences.verdict.no_name import why_no_name
from symolo.core.arrays import Array

WIDTH = 118
NARROWER = 0.95
"""Ratio of the standard errors after and before a trial, from which it narrows a number."""
HOW = {
    CaseKind.MOTOR_STEADY: "Let the motor come to rest before each row; t_s does not count these pauses. Set the "
    "voltage, and log current and speed at the time of the row, when they no longer change. The clock starts when the "
    "motor is first switched on.",
    CaseKind.MOTOR_STEP: "Let the motor come to rest before each run; its t_s begins at 0. Set the voltages of "
    "data.csv, and log current and speed in each of its rows. A voltage is held over the time that ends at its row.",
    CaseKind.TOF_BENCH: "Place the target as each row says, and log one reading. The clock starts when the sensor is "
    "switched on.",
    CaseKind.DRIVE_LOG: "Place the robot at the start, and let it drive the manoeuvres one after the other without a "
    "pause. Each of them begins and ends there, at rest. The poses are in the frame of the old data. `path.csv` has "
    "commands, wheel speeds and poses 20 times a second, `path.png` shows the path from above, and `wheel_speeds.h` "
    "has the set points for a board. On it, the middle of the axle keeps a distance of one wheel separation from the "
    "border of the floor.",
}
REHEARSAL = (
    "You can rehearse the drive in simulation, with the robot of the diagnosis. The command writes a dataset without "
    "images, whose data.csv has poses and ranges: look there whether the robot stays on the floor and sees the walls. "
    "It does not replace the measurement: data.csv of a dataset has no counts of the wheels, so it cannot fill the "
    "trial or be diagnosed together with the old case."
)
RUNS = {CaseKind.DRIVE_LOG: "manoeuvres"}


def trial_text(design: TrialDesign, command: str, simulation: str, folder: str) -> str:
    """Return the text of trial.md.

    Args:
        design: The trial.
        command: Command that diagnoses old and new data together.
        simulation: Command that simulates a drive.
        folder: Name of the folder with the data.csv to fill.
    """
    lines = [f"# The next trial for {design.diagnosis.measurement.name}", ""]
    lines += _wrapped(_purpose(design))
    if hindrance := [*hindrance_lines(design)]:
        # Before the rows: whoever can change the limit need not measure them.
        lines += ["", *hindrance, *_wrapped("The rows below are the best ones within the present limits.")]
    lines += ["", "## What to do", "", *_wrapped(HOW[design.trial.kind]), "", *_rows(design)]
    if design.trial.kind is CaseKind.DRIVE_LOG:
        lines += ["", *_wrapped(REHEARSAL), "", f"    {simulation}"]
    lines += ["", "## What to log", "", *_wrapped(_columns(design, folder))]
    lines += ["", "## What to expect", "", *_expected(design)]
    lines += ["", "## Then", "", f"    {command}", ""]
    return "\n".join(lines)


def _wrapped(text: str) -> list[str]:
    return wrap(text, WIDTH, break_long_words=False, break_on_hyphens=False)


def _purpose(design: TrialDesign) -> str:
    names = [model.name for model in design.models]
    if len(names) == 1:
        effects = names[0].split(" and ")
        only = f"Only {names[0]} remains. This trial determines its parameters"
        if len(effects) > 1:
            only = f"Only {listed(effects)} remain. This trial determines their parameters"
        return f"{only} as precisely as these limits allow."
    explanations = "; ".join(f"{model.name} ({_percent(model.weight)})" for model in design.models)
    return (
        f"{len(names)} explanations of the old data remain: {explanations}. This trial separates them as far as "
        "the limits allow."
    )


def _rows(design: TrialDesign) -> Iterator[str]:
    """Yield a table of the rows, or a list of the runs."""
    seconds = design.limits.units * design.limits.row_s
    if design.titles:
        runs = RUNS.get(design.trial.kind, "runs")
        if design.trial.kind is CaseKind.DRIVE_LOG:
            yield from _wrapped(_whereabouts(design))
            yield ""
        number = len(design.titles)
        yield f"{number} {runs if number > 1 else runs[:-1]} of {design.limits.row_s:g} s, {seconds:g} s in all:"
        yield ""
        yield from (f"{number}. {title}" for number, title in enumerate(design.titles, 1))
        return
    (trial,) = design.trial.trials
    inputs = [c for c in trial.channels if c.role is Role.INPUT and np.isfinite(c.values).any()]
    yield f"{len(trial.t_s)} rows of {design.limits.row_s:g} s, {seconds:g} s in all:"
    yield ""
    names = ["row", "t_s", *(channel.name for channel in inputs), *(label.name for label in trial.labels)]
    yield f"| {' | '.join(names)} |"
    yield "|" + "---|" * len(names)
    for k, t_s in enumerate(trial.t_s.tolist()):
        cells = [f"{k + 1}", f"{t_s:g}", *(f"{channel.values[k]:g}" for channel in inputs)]
        yield f"| {' | '.join([*cells, *(label.values[k] for label in trial.labels)])} |"


def _whereabouts(design: TrialDesign) -> str:
    """Return where a drive begins, and how far the robot leaves the planned path by each explanation."""
    text = f"The drive begins at {start_text(design)}, on a floor of {floor_text(design.limits)}."
    paths = expected_paths(design.trial, design.limits, design.diagnosis.nominal, robots_of(design.models))
    planned = planned_path(design)
    away = [
        f"{float(f'{1000.0 * np.hypot(*(path - planned)[:, :2].T).max():.2g}'):g} mm if the cause is {model.name}"
        for model, path in zip(design.models, paths, strict=False)
    ]
    return text + (f" The robot leaves the planned path by up to {', '.join(away)}." if away else "")


def _columns(design: TrialDesign, folder: str) -> str:
    if design.trial.kind is CaseKind.DRIVE_LOG:
        listed = ", ".join(c.name for c in design.trial.trials[0].channels if c.is_offered and c.name not in COMMANDS)
        return (
            f"Fill {listed} in {folder}/data.csv, 20 times a second, as in the old data; a log with more or fewer rows "
            "may replace all of its rows. Leave the other columns as they are. If markers and clocks are as they were "
            "in the old drives, you may append the rows to the old data.csv as a further trial instead: two cases that "
            "are diagnosed together have a heading, a place of the tracked body and clocks of their own each."
        )
    readings = [c for c in design.trial.trials[0].channels if c.role is Role.READING]
    listed = " and ".join(f"{channel.name} [{channel.unit}]" for channel in readings)
    return f"Fill {listed} in {folder}/data.csv. Leave the other columns as they are."


def _expected(design: TrialDesign) -> Iterator[str]:
    """Yield what to expect of the trial, as predictions of the fitted models."""
    if len(design.models) > 1:
        yield "| if the cause is | its rival is | separation | the rival is excluded |"
        yield "|---|---|---|---|"
        for pair in design.expected.pairs:
            yield f"| {pair.truth} | {pair.rival} | {pair.separation:.1f} sigma | {_percent(pair.excluded)} |"
        yield ""
        smallest = design.expected.smallest
        text = f"it alone remains with a probability of {_percent(design.expected.one_right)} or more"
        if smallest is not None and smallest.separation < WEAK:
            text = "expect that others remain beside it, since no trial within the limits distinguishes all of them"
        yield from _wrapped(f"If one of them is the cause, {text}.")
        yield ""
    yield "| if the cause is | number | value | standard error now | after the trial |"
    yield "|---|---|---|---|---|"
    for number in _distinct(design.expected.numbers):
        before, after = f"{number.before:.2g}", f"{number.after:.2g}"
        yield f"| {number.model} | {number.effect}.{number.number} | {number.value:.4g} | {before} | {after} |"
    yield ""
    if len(design.models) == 1 and all(n.after > NARROWER * n.before for n in design.expected.numbers):
        yield from _wrapped(
            "No trial within these limits narrows the numbers: their errors come from the tolerances of the nominal "
            "parameters, or need more rows."
        )
        yield ""
    yield from _wrapped(
        "These figures are predictions of the fitted models with the noise of the old data. They hold as far as the "
        f"models do: {_beyond(design)}."
    )


def hindrance_lines(design: TrialDesign) -> Iterator[str]:
    """Yield paragraphs if the trial does not distinguish all models: what decides without it, and what hinders most."""
    smallest = design.expected.smallest
    if smallest is None or smallest.separation >= WEAK:
        return
    if without_a_trial := why_no_name(design.diagnosis):
        yield from _wrapped(without_a_trial)
        yield ""
    text = (
        f"No trial within the limits distinguishes {smallest.truth} from {smallest.rival}: the best one separates them "
        f"by {smallest.separation:.2g} standard deviations, and {WEAK:g} are needed."
    )
    helpful = [limit for limit in design.hindrances if limit.smallest > 1.05 * smallest.separation]
    enough = [limit for limit in helpful if limit.smallest >= WEAK]
    if enough:
        text += f" {enough[0].text.capitalize()} would be enough ({enough[0].smallest:.2g})."
    elif helpful:
        reached = f"{helpful[0].smallest:.2g}"
        text += f" With {helpful[0].text}, the separation would be {reached}, which is still too small."
    else:
        text += " Neither more time nor a wider range helps: these sensors show both in the same way."
    yield from _wrapped(text)
    for kind in dict.fromkeys(e.kind for model in design.models for e in model.fit.hypothesis.effects):
        yield from _wrapped(f"- {kind.name} shows in: {kind.excitation}")
    yield ""


def _distinct(numbers: Sequence[ExpectedNumber]) -> list[ExpectedNumber]:
    return list({(n.model, n.effect, n.number): n for n in numbers}.values())


def _percent(share: float) -> str:
    return f"{min(share, 0.99):.0%}".replace("%", " %")


def _beyond(design: TrialDesign) -> str:
    """Return whether the trial leaves the range of the old data, as a clause."""
    left = []
    for channel in design.trial.trials[0].channels:
        if channel.role is not Role.INPUT:
            continue
        new, old = (_known(cases, channel.name) for cases in ((design.trial,), _old(design)))
        if len(new) and len(old) and (new.min() < old.min() - 1e-9 or new.max() > old.max() + 1e-9):
            left.append(f"{channel.name} was measured from {old.min():g} to {old.max():g}, and here it goes from ")
            left[-1] += f"{new.min():g} to {new.max():g}"
    return "; ".join(left) or "all inputs stay in the range that was measured"


def _old(design: TrialDesign) -> tuple[Measurement, ...]:
    measurement = design.diagnosis.measurement
    return measurement.cases or (measurement,)


def _known(cases: Sequence[Measurement], name: str) -> Array:
    values = np.concatenate([channel.values for case in cases for channel in case.across(name)])
    return values[np.isfinite(values)]
