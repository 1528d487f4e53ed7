"""The paper's Fig. 5: which channels are on, the line error that follows, and the tapes that it holds for."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from configs.schema.robot import LineSensor
from diagnosis.validation.line_sensor.rig import Tape, readings, sensor, spot_diameter_m, without_faults
from physics.control.following import line_error

POINTS = 961
REACH_PITCHES = 4.8
NARROWEST_M, WIDEST_M = 0.004, 0.040
BISECTIONS = 30
FIGURE_5 = ((0.0, (3, 4), 0.0), (-0.5, (4,), 0.5), (0.5, (3,), -0.5))
"""Offset of the robot to the left of the tape in pitches, channels that are on, line error (Eq. 12)."""


@dataclass(frozen=True)
class Case:
    offset_m: float
    active: tuple[int, ...]
    line_error: float | None
    """None where no channel is on."""
    active_in_figure_5: tuple[int, ...]
    line_error_in_figure_5: float

    @property
    def agrees(self) -> bool:
        return (self.active, self.line_error) == (self.active_in_figure_5, self.line_error_in_figure_5)


@dataclass(frozen=True)
class Threshold:
    threshold: float
    cases: tuple[Case, ...]
    offset_m: tuple[float, ...]
    line_error: tuple[float | None, ...]
    """Of the faultless sensor at each offset."""
    narrowest_tape_m: float | None
    """Of the tapes for which all cases are as in Fig. 5; None where they are not so for the bench's own."""
    widest_tape_m: float | None
    narrowest_closed_form_m: float
    """Both middle channels reach the tape: a pitch, and twice how far inside the edge the threshold lies."""
    widest_closed_form_m: float
    """Beside one channel above the middle no other reaches it: two pitches, and the same."""


def threshold_bench(config: LineSensor, tape: Tape) -> Threshold:
    """With a sensor without spread and noise, so that nothing but footprint and threshold decides."""
    quiet = without_faults(config, adc_bits=config.adc_bits)
    offset = np.linspace(-REACH_PITCHES, REACH_PITCHES, POINTS) * config.pitch_m
    rows = readings(sensor(quiet, tape, 0), offset)
    spot_sd_m = 0.25 * spot_diameter_m(config, config.height_m)
    share = (tape.floor_reflectance - config.threshold) / (tape.floor_reflectance - tape.reflectance)
    inside_m = spot_sd_m * float(ndtri(share))
    return Threshold(
        threshold=config.threshold,
        cases=_cases(quiet, tape),
        offset_m=tuple(offset.tolist()),
        line_error=tuple(line_error(row, config.threshold) for row in rows.tolist()),
        narrowest_tape_m=_last_good(quiet, tape, NARROWEST_M),
        widest_tape_m=_last_good(quiet, tape, WIDEST_M),
        narrowest_closed_form_m=config.pitch_m + 2.0 * inside_m,
        widest_closed_form_m=2.0 * config.pitch_m + 2.0 * inside_m,
    )


def _cases(config: LineSensor, tape: Tape) -> tuple[Case, ...]:
    found = []
    for pitches, active, error in FIGURE_5:
        row = readings(sensor(config, tape, 0), np.array([pitches * config.pitch_m]))[0].tolist()
        on = tuple(channel for channel, reading in enumerate(row) if reading < config.threshold)
        found.append(Case(pitches * config.pitch_m, on, line_error(row, config.threshold), active, error))
    return tuple(found)


def _last_good(config: LineSensor, tape: Tape, bad_m: float) -> float | None:
    """Width between the bench's own tape, where Fig. 5 holds, and a bad one, up to which it still does."""

    def holds(width_m: float) -> bool:
        return all(case.agrees for case in _cases(config, replace(tape, width_m=width_m)))

    good_m = tape.width_m
    if not holds(good_m):
        return None
    for _ in range(BISECTIONS):
        middle_m = 0.5 * (good_m + bad_m)
        good_m, bad_m = (middle_m, bad_m) if holds(middle_m) else (good_m, middle_m)
    return good_m
