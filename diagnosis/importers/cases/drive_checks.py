"""Notes on what is probably wrong in a drive: gaps, jumping counters, and wheels that do not belong to the pose."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Role
from diagnosis.measured.measurement import CHECK, Measurement
from diagnosis.measured.pose_by_ticks import MIN_SHARE, pose_by_ticks
from logs.counts import jump_note
from logs.drive import COUNTED
from logs.times import gap_note

MIN_GAP_STEPS = 10.0
"""Smallest gap that is noted, in usual steps: half a second."""
FAR_OFF = 1.4
"""Ratio of the distances of pose and wheels from which on a number of the wheels is wrong; no wheel slips as much."""
EDGES = (2.0, 4.0)
"""Counts per pulse of an encoder, by how many edges of its two channels are counted."""


@dataclass(frozen=True)
class CountedWheels:
    """Numbers of a robot by which ticks become distances."""

    radius_m: float
    ticks_per_turn: float


def drive_checks(wheels: CountedWheels, measurement: Measurement, *, has_wrong_unit: bool = False) -> Iterator[str]:
    """Yield a note for each sign that the log, its mapping or the numbers of the robot are wrong.

    With a wrong unit or a jumping counter, pose and wheels contradict each other in any case, so that only the cause is
    noted.

    Args:
        wheels: Numbers of the robot.
        measurement: The drive.
        has_wrong_unit: Whether another note says that a unit is wrong.
    """
    has_cause = has_wrong_unit
    for trial in measurement.trials:
        where = f"trial {trial.name}: " if len(measurement.trials) > 1 else ""
        readings = [channel.values for channel in trial.channels if channel.role is Role.READING]
        known = np.isfinite(readings).any(axis=0)
        if gap := gap_note(trial.t_s[known], MIN_GAP_STEPS):
            yield f"{where}{gap}"
        for name in COUNTED if measurement.has(*COUNTED) else ():
            if note := jump_note(f"{where}{name}", trial[name].values, trial.t_s):
                has_cause = True
                yield f"{CHECK} {note}"
    moved = None if has_cause else pose_by_ticks(measurement)
    if moved is None:
        return
    contradictions = list(moved.contradictions())
    yield from (f"{CHECK} {text}" for text in contradictions)
    if not contradictions and moved.is_forward_clear and moved.forward_share >= MIN_SHARE:
        yield from _travel_note(wheels, moved.span_m_per_tick)


def _travel_note(wheels: CountedWheels, m_per_tick: float) -> Iterator[str]:
    """Yield a note if the pose moves much farther than the wheels, or much less far."""
    ticks, radius_m = wheels.ticks_per_turn, wheels.radius_m
    ratio = m_per_tick * ticks / (2.0 * np.pi * radius_m)
    if 1.0 / FAR_OFF < ratio < FAR_OFF:
        return
    more = next((each for each in (*EDGES, *(1.0 / edges for edges in EDGES)) if 0.85 < ratio * each < 1.15), None)
    would = f"{ticks / ratio:.0f}"
    if more:
        would = f"{ticks * more:g}, {more:g} times as many, as if other edges were counted"
    yield (
        f"{CHECK} ticks_per_turn and wheel_diameter_m: the pose moves {ratio:.3g} times as far as the wheels; it would "
        f"fit with ticks_per_turn {would}, or with a wheel diameter of {2.0 * radius_m * ratio:.3g} m"
    )
