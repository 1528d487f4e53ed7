"""Readings right after a move: of which place they speak, in a scan and in the sensor's sampling."""

from dataclasses import dataclass

import numpy as np

from diagnosis.validation.range_sensor.recordings.scan import ScanRecord
from sensors.base import Sampling
from symolo.core.arrays import Array

JUMP_MM = 10.0
"""Between neighbouring points; below it old and new place cannot be told apart by their readings."""
NEAR = 0.25
"""Of the way between both: that near a reading is counted to one of them."""
DEVICE_PERIOD_S = 0.2
"""Of the high-accuracy profile that the scan was made with."""
STEPS_HZ = 10_000


@dataclass(frozen=True)
class AfterMove:
    """By number of the reading at a point, K values each."""

    moves: int
    """That changed the range by more than `JUMP_MM`."""
    share_of_way: tuple[float, ...]
    """0 the old place, 1 the new one, by least squares over all moves."""
    at_old_place: tuple[float, ...]
    """Share of the readings within a quarter of the way of the old place."""
    at_new_place: tuple[float, ...]
    same_as_before: tuple[float, ...]
    """Share of the readings that repeat the one before exactly, from the second on."""
    poll_s: float
    """Spacing of the readings, from how many of them repeat a value of the device's period, but for chance."""
    model: tuple[float, ...]
    """Share of the way in the sensor as configured, read at that spacing, the first time as soon as it stands."""
    model_at_device_period: tuple[float, ...]
    """Likewise with the period of the device's profile."""


def after_move(scan: ScanRecord, period_s: float, delay_s: float) -> AfterMove | None:
    """None where no move changes the range, or none leaves it: of the latter the spacing of the readings is read."""
    readings = scan.reading_mm
    old, new = scan.settled_mm[:-1], scan.settled_mm[1:]
    jumps = np.abs(new - old) > JUMP_MM
    if not jumps.any() or jumps.all():
        return None
    way = (new - old)[jumps, None]
    gone = (readings[1:] - old[:, None])[jumps]
    part = gone / way
    same = (readings[:, 1:] == readings[:, :-1]).mean(axis=0)
    poll_s = DEVICE_PERIOD_S * _share_new(readings[1:][~jumps])
    count = readings.shape[1]
    return AfterMove(
        moves=int(jumps.sum()),
        share_of_way=tuple(((gone * way).sum(axis=0) / (way**2).sum()).tolist()),
        at_old_place=tuple((np.abs(part) < NEAR).mean(axis=0).tolist()),
        at_new_place=tuple((np.abs(part - 1.0) < NEAR).mean(axis=0).tolist()),
        same_as_before=tuple(same.tolist()),
        poll_s=poll_s,
        model=modelled(period_s, delay_s, poll_s, count),
        model_at_device_period=modelled(DEVICE_PERIOD_S, delay_s, poll_s, count),
    )


def _share_new(steady: Array) -> float:
    """Of readings every s of a value that is new every T, a part s / T is new; some new ones are the same by chance.

    `steady`, (P, K), are readings where nothing changes; three apart they are of different values.
    """
    same = float(np.mean(steady[:, 1:] == steady[:, :-1]))
    by_chance = float(np.mean(steady[:, 3:] == steady[:, :-3])) if steady.shape[1] > 3 else 0.0
    return min(1.0, max(0.01, (1.0 - same) / max(1.0 - by_chance, 0.01)))


def modelled(period_s: float, delay_s: float, poll_s: float, count: int) -> tuple[float, ...]:
    """Share of moments of the move, over the sensor's period, after which reading 0, 1, ... is of the new place."""
    sampling = Sampling.from_seconds(period_s, delay_s, STEPS_HZ)
    # Far enough from the start that the sensor has delivered, whatever the delay.
    first = sampling.period_steps * (2 + sampling.delay_steps // sampling.period_steps)
    moves = range(first, first + sampling.period_steps)
    polls = [round(number * poll_s * STEPS_HZ) for number in range(count)]
    return tuple(float(np.mean([sampling.step_read_at(move + poll) >= move for move in moves])) for poll in polls)
