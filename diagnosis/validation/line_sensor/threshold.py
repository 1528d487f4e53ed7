"""The paper's Fig. 5: the channels that are on, the line error, and the widths of tape for which both hold."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from configs.schema.robot import LineSensor, RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.line_sensor.rig import Tape, readings, sensor, spot_diameter_m, without_faults
from diagnosis.validation.panels import Curve, Panel
from physics.control.following import line_error
from symolo.pages.plotting import BLUE, VERMILION

POINTS = 961
REACH_PITCHES = 4.8
MIN_WIDTH_M, MAX_WIDTH_M = 0.004, 0.040
BISECTIONS = 30
TOLERANCE_MM = 0.02
FIGURE_5 = ((0.0, (3, 4), 0.0), (-0.5, (4,), 0.5), (0.5, (3,), -0.5))
"""Offsets of the robot to the left of the tape in pitches, channels that are on, and line error (Eq. 12)."""


@dataclass(frozen=True)
class ThresholdCase:
    """A position of the robot over the tape, compared with the paper's Fig. 5."""

    offset_m: float
    active: tuple[int, ...]
    line_error: float | None
    """Line error in pitches; None if no channel is on."""
    active_in_figure_5: tuple[int, ...]
    line_error_in_figure_5: float

    @property
    def agrees(self) -> bool:
        return (self.active, self.line_error) == (self.active_in_figure_5, self.line_error_in_figure_5)


def threshold(robot: RobotConfig, _seed: int, tape: Tape | None = None) -> ExperimentResult:
    """Return the cases of Fig. 5 and the widths of tape for which they hold, with a sensor without faults."""
    config, tape = robot.line_sensor, tape or Tape()
    quiet = without_faults(config, adc_bits=config.adc_bits)
    offset = np.linspace(-REACH_PITCHES, REACH_PITCHES, POINTS) * config.pitch_m
    error = np.array(
        [line_error(row, config.threshold) for row in readings(sensor(quiet, tape, 0), offset).tolist()], np.float64
    )
    share = (tape.floor_reflectance - config.threshold) / (tape.floor_reflectance - tape.reflectance)
    # Distance inside the edge of the tape at which the middle of a spot reads the threshold.
    inside_m = 0.25 * spot_diameter_m(config, config.height_m) * float(ndtri(share))
    positions = cases(quiet, tape)
    levels = vars(tape) | {"threshold": config.threshold}
    tables = {"line_error": levels | {"offset_m": offset, "line_error": error}}
    tables |= {_name(case): vars(case) for case in positions}
    checks = [*_checks_of_cases(positions), *_checks_of_widths(quiet, tape, inside_m)]
    points = [1e3 * case.offset_m for case in positions], [case.line_error_in_figure_5 for case in positions]
    curves = (
        Curve(1e3 * offset, error, "mean weight of the channels that are on (Eq. 12)", BLUE, ".", size=3),
        Curve(*points, "the paper's Fig. 5", VERMILION, "o", size=9),
    )
    axes = ("robot left of the tape's middle [mm]", "line error [pitches]")
    return ExperimentResult(tables, checks, (Panel("Line error with the threshold", *axes, curves),))


def _name(case: ThresholdCase) -> str:
    return f"robot {1e3 * case.offset_m:+.2f} mm off the tape"


def _checks_of_cases(positions: Sequence[ThresholdCase]) -> Iterator[ValidationCheck]:
    """Yield the line error of each case, and the number of cases in which other channels are on than in the paper."""
    for case in positions:
        value = np.nan if case.line_error is None else case.line_error
        detail = "on: " + (" ".join(f"L{channel}" for channel in case.active) or "none")
        expected = case.line_error_in_figure_5
        yield ValidationCheck(f"line error, {_name(case)}", value, expected, 0, "Fig. 5", "pitches", detail)
    other = sum(case.active != case.active_in_figure_5 for case in positions)
    yield ValidationCheck("cases with other channels on", other, 0, 0, "Fig. 5")


def _checks_of_widths(config: LineSensor, tape: Tape, inside_m: float) -> Iterator[ValidationCheck]:
    """Yield the narrowest and the widest tape for which the cases hold.

    Args:
        config: The line sensor, without faults.
        tape: The tape.
        inside_m: Distance inside the edge of the tape at which the middle of a spot reads the threshold.
    """
    yield ValidationCheck(
        "narrowest tape for which Fig. 5 holds",
        1e3 * last_good_m(config, tape, MIN_WIDTH_M),
        # Both middle channels must see the tape.
        1e3 * (config.pitch_m + 2.0 * inside_m),
        TOLERANCE_MM,
        "a pitch and twice the depth inside the edge at which a channel turns on",
        "mm",
    )
    yield ValidationCheck(
        "widest tape for which Fig. 5 holds",
        1e3 * last_good_m(config, tape, MAX_WIDTH_M),
        # With one channel above the middle of the tape, no other channel may see it.
        1e3 * (2.0 * config.pitch_m + 2.0 * inside_m),
        TOLERANCE_MM,
        "two pitches and twice the depth inside the edge at which a channel turns on",
        "mm",
    )


def cases(config: LineSensor, tape: Tape) -> tuple[ThresholdCase, ...]:
    """Return the channels and the line error in the three cases of Fig. 5."""
    positions = []
    for pitches, active, error in FIGURE_5:
        row = readings(sensor(config, tape, 0), np.array([pitches * config.pitch_m]))[0].tolist()
        on = tuple(channel for channel, reading in enumerate(row) if reading < config.threshold)
        positions.append(ThresholdCase(pitches * config.pitch_m, on, line_error(row, config.threshold), active, error))
    return tuple(positions)


def last_good_m(config: LineSensor, tape: Tape, bad_m: float) -> float:
    """Return the width between that of the tape and a bad one up to which Fig. 5 holds, by bisection.

    It is NaN if Fig. 5 does not hold for the tape itself.
    """

    def holds(width_m: float) -> bool:
        return all(case.agrees for case in cases(config, replace(tape, width_m=width_m)))

    good_m = tape.width_m
    if not holds(good_m):
        return np.nan
    for _ in range(BISECTIONS):
        middle_m = 0.5 * (good_m + bad_m)
        good_m, bad_m = (middle_m, bad_m) if holds(middle_m) else (good_m, middle_m)
    return good_m
