"""A measurement with inputs and without readings, of the same kind and robot as the old data."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.measured.case_files.nominal import NominalDrive, NominalTof
from diagnosis.measured.channel import Channel, Label, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.tables.time_series import TimeSeries

KINDS = (CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP, CaseKind.TOF_BENCH, CaseKind.DRIVE_LOG)
"""Kinds of measurement for which a trial can be designed."""
INSTEAD = (
    "from a log of your own, make a case with `symolo case init LOG` and diagnose it; of a simulated robot, simulate "
    "other drives"
)
"""What to do with data that are no case."""


def without_trials(measurement: Measurement) -> str | None:
    """Return why `symolo next` designs no trial for a measurement, as the end of a sentence; None if it does."""
    cases = measurement.cases or (measurement,)
    if any(case.kind not in KINDS or case.nominal is None for case in cases):
        return f"which are no case with a nominal.yaml: {INSTEAD}"
    if len({case.kind for case in cases}) > 1:
        return "which are cases of several kinds: diagnose those of one kind alone"
    return None


def template_of(measurement: Measurement) -> Measurement:
    """Return the first case of a measurement, whose kind and nominal parameters the next trial has.

    Raises:
        InputError: No trial can be designed for such data.
    """
    cases = measurement.cases or (measurement,)
    kinds = {case.kind for case in cases}
    if len(kinds) > 1:
        cure = "name a diagnosis of cases of one kind"
        raise InputError("cases of several kinds", got=", ".join(sorted(kinds)), cure=cure)
    template = cases[0]
    if template.kind not in KINDS:
        allowed = f"cases of kind {', '.join(KINDS)}"
        raise InputError(f"no trial can be designed for data of kind {template.kind}", allowed=allowed)
    if template.nominal is None:
        raise InputError("no trial can be designed for data without a nominal.yaml", cure=INSTEAD)
    return template


def trial_with(
    template: Measurement,
    name: str,
    t_s: Array,
    inputs: Mapping[str, Array],
    *,
    words: Mapping[str, Sequence[str]] | None = None,
    begins_s: float = 0.0,
) -> Trial:
    """Return a trial with inputs (N,) and without readings; nothing of it is held out.

    Args:
        template: The old data, whose channels the trial has.
        name: Name of the trial.
        t_s: (N,), times.
        inputs: Values of the inputs by channel; inputs that are left out are missing.
        words: Words of the rows by label.
        begins_s: Time of the beginning since the session began.
    """
    rows = len(t_s)
    channels = []
    for channel in template.trials[0].channels:
        values = inputs.get(channel.name, np.full(rows, np.nan))
        is_reading = channel.role is Role.READING
        channels.append(
            Channel.logged(
                TimeSeries(channel.name, channel.unit, t_s.copy(), values.copy()),
                channel.role,
                noise_sd=_noise_sd(template, channel.name, inputs, rows) if is_reading else None,
                noise_correlation=channel.noise_correlation,
                clock=channel.clock,
            )
        )
    labels = tuple(Label(label, tuple(values)) for label, values in (words or {}).items())
    return Trial(name, t_s, np.zeros(rows, dtype=bool), tuple(channels), labels, begins_s)


def nominal_drive(template: Measurement) -> NominalDrive:
    """Return the nominal parameters of a drive."""
    if not isinstance(template.nominal, NominalDrive):
        raise TypeError(f"{template.name} is no drive")
    return template.nominal


def floor_of(template: Measurement) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the middle and the size of the floor on which the robot drove, in the frame of its poses.

    It is the room of nominal.yaml, or else the rectangle around the old poses.
    """
    room = nominal_drive(template).world
    if room is not None:
        return (0.5 * room.room_x_m, 0.5 * room.room_y_m), (room.room_x_m, room.room_y_m)
    around_m = 2.0 * nominal_drive(template).robot.wheel_separation_m.value
    middles, sizes = [], []
    for name in ("x_m", "y_m"):
        places_m = np.concatenate([channel.values[channel.good] for channel in template.across(name)])
        low_m, high_m = (float(places_m.min()), float(places_m.max())) if len(places_m) else (0.0, 0.0)
        middles.append(0.5 * (low_m + high_m))
        sizes.append(high_m - low_m + around_m)
    return (middles[0], middles[1]), (sizes[0], sizes[1])


def reachable_m_s(template: Measurement) -> float:
    """Return the speed of a wheel over the floor that the nominal motor keeps at its full voltage; inf without one.

    The torque constant times the current is the friction, and the rest of the voltage is induced: U = R (B w + Tc) / K
    + K w in a steady state.
    """
    nominal = nominal_drive(template)
    if (motor := nominal.motor) is None:
        return np.inf
    constant, viscous = motor.torque_constant_N_m_A.value, motor.viscous_friction_N_m_s_rad.value
    ohm_per_constant = motor.winding_resistance_ohm.value / constant
    left_V = motor.supply_voltage_V - ohm_per_constant * motor.coulomb_friction_N_m.value
    return nominal.robot.wheel_radius_m.value * left_V / (constant + ohm_per_constant * viscous)


def to_fill(trial: Measurement) -> Measurement:
    """Return a trial of a drive with its commands alone: all else is to be logged."""
    return measurement_of(trial, [trial_with(trial, each.name, each.t_s, _commands(each)) for each in trial.trials])


def _commands(trial: Trial) -> Mapping[str, Array]:
    return {name: trial[name].values for name in ("v_cmd_m_s", "w_cmd_rad_s")}


def measurement_of(template: Measurement, trials: Sequence[Trial], name: str = "next_trial") -> Measurement:
    """Return trials as a measurement of the same robot as the old data."""
    return replace(
        template, name=name, source=MeasurementSource("the next trial", ()), trials=tuple(trials), notes=(), cases=()
    )


def _noise_sd(template: Measurement, name: str, inputs: Mapping[str, Array], rows: int) -> Array | None:
    if isinstance(template.nominal, NominalTof):
        return template.nominal.noise.sd_m(inputs["distance_m"])
    stated = [channel.noise_sd for channel in template.across(name)]
    return None if stated[0] is None else np.full(rows, float(np.median(stated[0])))
