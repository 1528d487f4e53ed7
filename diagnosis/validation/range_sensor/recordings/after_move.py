"""Readings right after a move, in a scan and by the simulated sensor: do they show the old or the new place?"""

import numpy as np

from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording
from diagnosis.validation.range_sensor.stand import SensorOnStand
from sensors.base import Sampling
from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE, PALE, VERMILION

JUMP_MM = 10.0
"""Smallest difference between neighbouring points whose old and new readings can be distinguished."""
NEAR = 0.25
"""Distance from the old or the new range, as a share of the change, within which a reading shows that place."""
DEVICE_PERIOD_S = 0.2
"""Period of the device's high-accuracy profile, with which the scan was made."""
TOLERANCE = 0.15
"""Largest difference in the share of the change for which a held value explains the readings."""
STEPS_HZ = 10_000


def after_move(scan: ScanRecording, mounted: SensorOnStand) -> ExperimentResult | None:
    """Return the share of the change of range that each reading after a move shows: 0 for the old place, 1 for the new.

    None if no move changes the range, or every move does: the time between readings is measured where nothing changes.
    """
    readings = scan.reading_mm
    old, new = scan.settled_mm[:-1], scan.settled_mm[1:]
    jumps = np.abs(new - old) > JUMP_MM
    if not jumps.any() or jumps.all():
        return None
    change = (new - old)[jumps, None]
    changed = (readings[1:] - old[:, None])[jumps]
    part = changed / change
    poll_s = DEVICE_PERIOD_S * _share_new(readings[1:][~jumps])
    count = readings.shape[1]
    # Least squares over all moves.
    shares = (changed * change).sum(axis=0) / (change**2).sum()
    configured = modelled(mounted.tof.period_s, mounted.tof.delay_s, poll_s, count)
    device_readings = modelled(DEVICE_PERIOD_S, mounted.tof.delay_s, poll_s, count)
    table = {
        "moves": int(jumps.sum()),
        "share_of_change": shares,
        "at_old_place": (np.abs(part) < NEAR).mean(axis=0),
        "at_new_place": (np.abs(part - 1.0) < NEAR).mean(axis=0),
        "same_as_reading_before": (readings[:, 1:] == readings[:, :-1]).mean(axis=0),
        "reading_every_s": poll_s,
        "model": configured,
        "model_at_device_period": device_readings,
    }
    as_configured = " ".join(f"{share:.2f}" for share in configured)
    detail = f"{table['moves']} moves, a reading every {poll_s:.2f} s; the model as configured: {as_configured}"
    checks = [
        ValidationCheck(
            f"share of the change in reading {k + 1} after a move",
            float(device_readings[k]),
            float(shares[k]),
            TOLERANCE,
            f"the recording; model with the device's period of {DEVICE_PERIOD_S:g} s",
            detail="" if k else detail,
        )
        for k in range(count)
    ]
    note = (
        "NOT IN THIS ROBOT: the device integrates light over its whole period; without range_gathering_time, a reading "
        "shows one moment. A scan that stands still at each point cannot show the difference"
    )
    number = np.arange(1, count + 1)
    curves = (
        Curve(number, shares, "measured", PALE, kind="bars"),
        Curve(number, device_readings, f"model, {DEVICE_PERIOD_S:g} s", BLUE, "x-"),
        Curve(number, configured, "model as configured", VERMILION, "+--"),
    )
    axes = "number of the reading at the new place", "share of the change from the old to the new range"
    panel = Panel(f"After a move ({table['moves']} moves)", *axes, curves)
    return ExperimentResult({"after_move": table}, checks, (panel,), (note,))


def _share_new(steady: Array) -> float:
    """Return the share of readings (P, K), where nothing changes, that are new values of the device.

    If the device has a new value every T and is read every s, the share is s / T. Some new values are equal to the one
    before by chance. Readings that are three apart are certainly different values, and show how many.
    """
    same = float(np.mean(steady[:, 1:] == steady[:, :-1]))
    by_chance = float(np.mean(steady[:, 3:] == steady[:, :-3])) if steady.shape[1] > 3 else 0.0
    return min(1.0, max(0.01, (1.0 - same) / max(1.0 - by_chance, 0.01)))


def modelled(period_s: float, delay_s: float, poll_s: float, count: int) -> Array:
    """Return the share of moves after which reading 0, 1, ... shows the new place, over all phases of the period."""
    sampling = Sampling.from_seconds(period_s, delay_s, STEPS_HZ)
    # Late enough that the sensor has delivered a value, whatever the delay.
    first = sampling.period_steps * (2 + sampling.delay_steps // sampling.period_steps)
    moves = range(first, first + sampling.period_steps)
    polls = [round(number * poll_s * STEPS_HZ) for number in range(count)]
    return np.array([np.mean([sampling.step_read_at(move + poll) >= move for move in moves]) for poll in polls])
