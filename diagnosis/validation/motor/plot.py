"""The picture of the motor bench: steady states with residuals (the paper's Fig. 10), steps, stiction, energy."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.validation.motor.bench import MotorBench
from diagnosis.validation.motor.energy import EnergyBench
from diagnosis.validation.motor.steady_states import Candidate, SteadyBench
from diagnosis.validation.motor.steps import StepBench
from diagnosis.validation.motor.stiction import StictionBench
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, SKY, VERMILION, finished, png

STEP_STYLES = ((SKY, ":"), (GREEN, "-."), (VERMILION, "--"), (BLUE, "-"))


@dataclass(frozen=True)
class _Style:
    color: str
    dashes: str
    marker: str
    width: float
    """Of the line [points]."""


def motor_picture(bench: MotorBench) -> bytes:
    """PNG; left column speed, right column current, below them stiction and energy."""
    figure = Figure(figsize=(11.5, 15.5), layout="constrained")
    grid = figure.add_gridspec(4, 2, height_ratios=(3, 1.8, 2.7, 2.9))
    axes = [[figure.add_subplot(grid[row, column]) for column in range(2)] for row in range(4)]
    for column in range(2):
        axes[1][column].sharex(axes[0][column])
    _speeds(axes[0][0], axes[1][0], bench.steady)
    _currents(axes[0][1], axes[1][1], bench.steady)
    _steps(axes[2][0], axes[2][1], bench.steps)
    _stiction(axes[3][0], bench.stiction)
    _energy(axes[3][1], bench.energy)
    figure.suptitle(f"Motor bench: {bench.steady.robot.name}, right motor, off load")
    return png(figure)


def _speeds(over: Axes, under: Axes, steady: SteadyBench) -> None:
    for found, style in _shown(steady):
        curve = found.curve
        over.plot(curve.voltage_V, curve.speed_rad_s, style.dashes, color=style.color, lw=style.width, label=found.name)
    over.plot(steady.voltage_V, steady.measured_speed_rad_s, "o", color=BLACK, ms=4, label="measured (Table 1)")
    finished(over, "Steady state: speed (paper Fig. 10)", "voltage [V]", "speed [rad/s]")
    for found, style in _shown(steady):
        _residuals(under, steady, found.speed_residual_rad_s.by_row, style)
    finished(under, "model less measured", "voltage [V]", "speed [rad/s]", legend=False)


def _currents(over: Axes, under: Axes, steady: SteadyBench) -> None:
    for found, style in _shown(steady):
        curve, current = found.curve, _milli(found.curve.current_A)
        over.plot(curve.voltage_V, current, style.dashes, color=style.color, lw=style.width, label=found.name)
    over.plot(steady.voltage_V, _milli(steady.measured_current_A), "o", color=BLACK, ms=4, label="measured (Table 1)")
    finished(over, "Steady state: current (paper Fig. 10)", "voltage [V]", "current [mA]")
    for found, style in _shown(steady):
        _residuals(under, steady, _milli(found.current_residual_A.by_row), style)
    finished(under, "model less measured", "voltage [V]", "current [mA]", legend=False)


def _shown(steady: SteadyBench) -> tuple[tuple[Candidate, _Style], ...]:
    """The literal fit lies wide and pale below the rest, for a nominal robot's motor is just that."""
    return (
        (steady.literal_fit, _Style(ORANGE, "-", "o", 3.5)),
        (steady.robot, _Style(BLUE, "-", "o", 1.5)),
        (steady.printed_variant, _Style(VERMILION, "--", "s", 1.5)),
        (steady.table_2, _Style(GREEN, ":", "^", 1.5)),
    )


def _residuals(axes: Axes, steady: SteadyBench, by_row: Sequence[float], style: _Style) -> None:
    axes.axhline(0.0, color=GREY, lw=0.8)
    line, size = style.marker + style.dashes, 2.0 * style.width
    axes.plot(steady.voltage_V, by_row, line, color=style.color, ms=size, lw=0.7 * style.width)


def _steps(speed: Axes, current: Axes, steps: StepBench) -> None:
    for response, (color, dashes) in zip(steps.responses, STEP_STYLES, strict=True):
        label = f"{response.voltage_V:g} V"
        time = _milli(response.time_s)
        speed.plot(time, response.speed_rad_s, dashes, color=color, label=label)
        current.plot(time, _milli(response.current_A), dashes, color=color, label=label)
        if response.time_to_63_percent_s is not None:
            speed.plot(1e3 * response.time_to_63_percent_s, 0.632 * response.settled_rad_s, "o", color=color, ms=5)
    time_constant_ms = 1e3 * (steps.time_constant_s + steps.input_delay_s)
    speed.axvline(time_constant_ms, color=GREY, lw=1, label=f"closed form: {time_constant_ms:.1f} ms")
    speed.set_ylim(bottom=0.0)
    finished(speed, "Step from rest: speed, points at 63 %", "time [ms]", "speed [rad/s]", beside=True)
    finished(current, "Step from rest: current, inductance neglected", "time [ms]", "current [mA]", beside=True)


def _stiction(axes: Axes, stiction: StictionBench) -> None:
    voltage = _milli(stiction.voltage_V)
    axes.plot(voltage, stiction.speed_rad_s, color=BLUE, label="slow ramp up, down, back to 0")
    if stiction.breakaway_V is not None:
        axes.plot(1e3 * stiction.breakaway_V, 0.0, "^", color=VERMILION, ms=8, label="breaks away")
    if stiction.stops_V is not None:
        axes.plot(1e3 * stiction.stops_V, 0.0, "v", color=ORANGE, ms=8, label="comes to rest")
    for sign in (-1, 1):
        label = "closed form R Tq / K" if sign > 0 else None
        axes.axvline(sign * 1e3 * stiction.breakaway_closed_form_V, color=GREY, ls="--", lw=1, label=label)
    finished(axes, "Stiction: slow ramp of voltage, dashed: closed form", "voltage [mV]", "speed [rad/s]")
    if stiction.breakaway_V is not None and stiction.stops_V is not None:
        _close_up(axes, stiction, 1e3 * stiction.breakaway_V, 1e3 * stiction.stops_V)


def _close_up(axes: Axes, stiction: StictionBench, breaks_mV: float, stops_mV: float) -> None:
    """Where the wheel breaks away and where it stops, which lie close to each other."""
    inset = axes.inset_axes((0.6, 0.1, 0.37, 0.3))
    inset.plot(_milli(stiction.voltage_V), stiction.speed_rad_s, color=BLUE)
    inset.plot(breaks_mV, 0.0, "^", color=VERMILION, ms=8)
    inset.plot(stops_mV, 0.0, "v", color=ORANGE, ms=8)
    for closed_V in (stiction.breakaway_closed_form_V, stiction.stops_closed_form_V):
        inset.axvline(1e3 * closed_V, color=GREY, ls="--", lw=1)
    margin = max(2.0, abs(breaks_mV - stops_mV))
    inset.set_xlim(min(stops_mV, breaks_mV) - margin, max(stops_mV, breaks_mV) + margin)
    highest = max(abs(speed) for speed in stiction.speed_rad_s)
    inset.set_ylim(-0.03 * highest, 0.08 * highest)
    inset.tick_params(labelsize="x-small")
    inset.set_title("close-up", fontsize="small", backgroundcolor="white", pad=6)
    inset.grid(alpha=0.3)


def _energy(axes: Axes, energy: EnergyBench) -> None:
    time = _milli(energy.time_s)
    heat = [a + b for a, b in zip(energy.winding_J, energy.friction_J, strict=True)]
    whole = [a + b for a, b in zip(heat, energy.kinetic_J, strict=True)]
    axes.fill_between(time, energy.winding_J, color=ORANGE, label="heat of the winding", lw=0)
    axes.fill_between(time, energy.winding_J, heat, color=BLUE, label="heat of friction", lw=0)
    axes.fill_between(time, heat, whole, color=SKY, label="kinetic energy", lw=0)
    axes.plot(time, energy.electrical_J, "--", color=BLACK, lw=1.5, label="electrical work")
    finished(axes, "Energy: run, brake, reverse, plug, brake", "time [ms]", "sum from the start [J]")


def _milli(values: Sequence[float]) -> list[float]:
    return [1e3 * value for value in values]
