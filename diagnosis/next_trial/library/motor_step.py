"""Runs of a step log: voltages over time, from rest."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalStep
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.next_trial.library.base import Library, Units
from diagnosis.next_trial.limits import Limits
from diagnosis.next_trial.template import measurement_of, trial_with
from symolo.core.arrays import Array
from symolo.core.errors import InputError

AMPLITUDES = (1.0, 0.6, 0.3)
"""Sizes of a waveform, relative to the highest voltage."""
STAIRS = 8
"""Number of levels of a staircase."""
PULSE_BITS = (0.04, 0.12)
"""Shortest times between two switches of a pseudo-random binary sequence [s]."""
PAUSE_S = 0.05
"""Time at 0 V before a waveform, in which the offsets of the instruments are seen."""
REST_S = 1.0
"""Time between two runs, in which the motor comes to rest."""


@dataclass(frozen=True)
class Waveform:
    """Shape of a run, relative to its amplitude."""

    title: str
    values: Array
    """(N,), between -1 and 1."""
    reverses: bool


def motor_step(template: Measurement, limits: Limits, robots: Sequence[RobotConfig]) -> Library:
    """Return the runs for the limits.

    Raises:
        InputError: The old data state no sample rate.
    """
    del robots
    if not isinstance(template.nominal, NominalStep):
        raise InputError("no sample rate is stated", cure="add sample_rate_Hz to nominal.yaml")
    period_s = 1.0 / template.nominal.sample_rate_Hz
    samples = int(limits.row_s / period_s + 1e-6)
    t_s = period_s * np.arange(1.0, samples + 1.0)
    runs = [
        (shape.title, sign * share * limits.max_voltage_V, shape.values)
        for shape in waveforms(t_s)
        if not (shape.reverses and limits.one_direction)
        for share in AMPLITUDES
        for sign in ((1.0,) if limits.one_direction or shape.reverses else (1.0, -1.0))
    ]

    def trial(number: int, unit: int) -> Trial:
        begins_s = (number - 1) * (limits.row_s + REST_S)
        _, amplitude_V, values = runs[unit]
        voltage_V = np.round(amplitude_V * values, 3)
        return trial_with(template, str(number), t_s.copy(), {"u_cmd_V": voltage_V}, begins_s=begins_s)

    def composed(units: Units) -> Measurement:
        return measurement_of(template, [trial(k + 1, unit) for k, unit in enumerate(units.tolist())])

    return Library(
        composed(np.arange(len(runs))),
        np.arange(len(runs)),
        is_unit_a_row=False,
        slots=tuple(np.arange(len(runs)) for _ in range(limits.units)),
        composed=composed,
        ordered=np.sort,
        titles=tuple(f"{title}, of {round(amplitude_V, 3):g} V" for title, amplitude_V, _ in runs),
    )


def waveforms(t_s: Array) -> Iterator[Waveform]:
    """Yield the waveforms at times (N,) that begin one period after rest."""
    active = t_s > PAUSE_S
    share = np.clip((t_s - PAUSE_S) / (t_s[-1] - PAUSE_S), 0.0, 1.0)
    since_s = np.maximum(t_s - PAUSE_S, 0.0)

    def shape(title: str, values: Array, *, reverses: bool) -> Waveform:
        return Waveform(title, np.where(active, values, 0.0), reverses)

    yield shape("a step that is held", np.ones_like(t_s), reverses=False)
    yield shape("a step, then 0 V", (share < 0.5).astype(float), reverses=False)
    yield shape("a step, then its reverse", np.where(share < 0.5, 1.0, -1.0), reverses=True)
    for period_s in (1.2, 0.6, 0.25, 0.1):
        yield shape(f"a square wave of {period_s:g} s", _square(since_s, period_s), reverses=True)
        yield shape(f"pulses of {period_s / 2:g} s", 0.5 + 0.5 * _square(since_s, period_s), reverses=False)
    rising = 1.0 - np.abs(2.0 * share - 1.0)
    yield shape("a ramp up and down", rising, reverses=False)
    yield shape("a ramp up, down and in reverse", np.interp(share, (0, 0.25, 0.75, 1.0), (0, 1, -1, 0)), reverses=True)
    yield shape("a staircase up and down", np.ceil(rising * STAIRS) / STAIRS, reverses=False)
    for last_hz in (3.0, 10.0):
        phase = 2.0 * np.pi * (0.3 * since_s + (last_hz - 0.3) * since_s**2 / (2.0 * t_s[-1]))
        yield shape(f"a chirp from 0.3 to {last_hz:g} Hz", np.sin(phase), reverses=True)
    for bit_s in PULSE_BITS:
        yield shape(f"random switching, at least {bit_s:g} s apart", _binary(since_s, bit_s), reverses=True)


def _square(since_s: Array, period_s: float) -> Array:
    return np.where(np.floor(2.0 * since_s / period_s + 1e-9) % 2.0 == 0.0, 1.0, -1.0)


def _binary(since_s: Array, bit_s: float) -> Array:
    """Return a maximum-length sequence of 127 bits (N,), of -1 and 1 (x^7 + x^6 + 1)."""
    register, bits = 0b1111111, []
    for _ in range(127):
        bits.append(1.0 if register & 1 else -1.0)
        register = (register >> 1) | (((register ^ (register >> 1)) & 1) << 6)
    return np.array(bits)[np.floor(since_s / bit_s + 1e-9).astype(np.int64) % 127]
