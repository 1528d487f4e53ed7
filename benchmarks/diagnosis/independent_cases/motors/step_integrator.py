"""Speeds and currents of step trials, sampled every 5 ms, from a fine integration.

Each lane starts at rest. Its command u[k] (V) is held over the 5 ms that end at sample k.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, Law, current
from benchmarks.diagnosis.independent_cases.motors.two_bodies import Joint
from benchmarks.diagnosis.independent_cases.motors.wheel_step import advance
from benchmarks.diagnosis.independent_cases.recipes import Array

DT_S = 0.005


@dataclass(frozen=True)
class Lane:
    """One trial of one variant of the robot."""

    law: Law
    u_V: Array  # (samples,), voltage that the bridge really gives
    delay_s: float
    lag_s: float  # time constant of the first-order lag of the voltage


def mean_command(u: Array, delay: Array, steps: int) -> Array:
    """Return the mean of the delayed command (V) over every sub-step, (lanes, samples * steps).

    u is (lanes, samples); delay (lanes,) is in samples; before the first sample the command is 0.
    """
    lanes, samples = u.shape
    area = np.concatenate([np.zeros((lanes, 1)), np.cumsum(u, axis=1)], axis=1)
    edge = np.arange(samples * steps + 1) / steps
    at = np.clip(edge[None, :] - delay[:, None], 0, samples)
    whole = np.minimum(at.astype(int), samples - 1)
    lane = np.arange(lanes)[:, None]
    at_edge = area[lane, whole] + (at - whole) * u[lane, whole]
    return np.diff(at_edge, axis=1) * steps


def _command_at_samples(u: Array, delay_s: Array) -> Array:
    """Return the delayed command (V) at the sample times themselves, (lanes, samples)."""
    back = np.floor(delay_s / DT_S + 1e-9).astype(int)
    index = np.arange(u.shape[1])[None, :] - back[:, None]
    return np.where(index >= 0, np.take_along_axis(u, np.maximum(index, 0), axis=1), 0.0)


class _Lag:
    """First-order lag of the voltages; time_constant (lanes,) in s, zero where there is none."""

    def __init__(self, time_constant: Array, h: float) -> None:
        self.lanes = time_constant > 0
        self.keep = np.exp(-h / np.maximum(time_constant, 1e-9))
        self.share = (1 - self.keep) * time_constant / h
        self.state = np.zeros(len(time_constant))

    def mean(self, now: Array) -> Array:
        """Return the mean voltage over a sub-step with that command, and go on to its end."""
        mean = np.where(self.lanes, now + (self.state - now) * self.share, now)
        self.state = now + (self.state - now) * self.keep
        return mean


def run(lanes: list[Lane], steps: int, joint: Joint | None = None) -> tuple[Array, Array]:
    """Return the motor's speed (lanes, samples * steps + 1) in rad/s and its current (lanes, samples) in A.

    A joint connects the sides of the gear; None is a rigid one.
    """
    laws = Lanes.stack([lane.law for lane in lanes])
    u = np.stack([lane.u_V for lane in lanes])
    delay = np.array([lane.delay_s for lane in lanes])
    samples, h = u.shape[1], DT_S / steps
    mean, at_sample = mean_command(u, delay / DT_S, steps), _command_at_samples(u, delay)
    lag = _Lag(np.array([lane.lag_s for lane in lanes]), h)
    lagging = bool(lag.lanes.any())
    w, angle = np.zeros(len(lanes)), np.zeros(len(lanes))
    history = np.zeros((len(lanes), samples * steps + 1))
    amps = np.zeros((len(lanes), samples))
    varies = laws.varies
    p = laws.column(0)
    for k in range(samples):
        if varies:
            p = laws.column(k)
        if joint is not None and (varies or k == 0):
            joint.share(p)
        for m in range(k * steps, (k + 1) * steps):
            volts = lag.mean(mean[:, m]) if lagging else mean[:, m]
            after = advance(p, volts, w, angle, h=h) if joint is None else joint.step(p, volts, w, angle, h)
            angle = angle + 0.5 * h * (w + after)
            w = after
            history[:, m + 1] = w
        amps[:, k] = current(p, np.where(lag.lanes, lag.state, at_sample[:, k]), w)
    return history, amps


def sampled(history: Array, steps: int, delay_s: float = 0.0) -> Array:
    """Return the speed (rad/s) of one lane at the sample times minus a delay, by linear interpolation."""
    at = np.arange(1, (len(history) - 1) // steps + 1) * steps - delay_s / DT_S * steps
    return np.interp(at, np.arange(len(history)), history)


def filtered(history: Array, steps: int, time_constant_s: float) -> Array:
    """Return the speed of one lane after a first-order low-pass filter that starts at zero.

    The speed is linear within a sub-step, so that the filter is exact also where it is faster than a sub-step.
    """
    h = DT_S / steps
    keep = float(np.exp(-h / time_constant_s))
    # Behind a ramp of slope a, a filter lags by a * time constant, after what it had at the beginning has decayed.
    behind = np.diff(history) / h * time_constant_s
    smooth, level = np.zeros(len(history)), 0.0
    for i, lag in enumerate(behind.tolist()):
        level = history[i + 1] - lag + (level - history[i] + lag) * keep
        smooth[i + 1] = level
    return smooth
