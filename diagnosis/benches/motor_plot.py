"""The picture of the motor bench: steady states with residuals (the paper's Fig. 10), steps, stiction, energy."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.benches.motor import MotorBench
from diagnosis.benches.motor_energy import EnergyBench
from diagnosis.benches.motor_steady import Candidate, SteadyBench
from diagnosis.benches.motor_steps import StepBench
from diagnosis.benches.motor_stiction import StictionBench
from diagnosis.benches.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, SKY, VERMILION, finished, png

STEP_STYLES = ((SKY, ":"), (GREEN, "-."), (VERMILION, "--"), (BLUE, "-"))


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
    for found, color, dashes, _ in _shown(steady):
        over.plot(found.curve.voltage_V, found.curve.speed_rad_s, dashes, color=color, label=found.name)
    over.plot(steady.voltage_V, steady.measured_speed_rad_s, "o", color=BLACK, ms=4, label="measured (Table 1)")
    finished(over, "Steady state: speed (paper Fig. 10)", "voltage [V]", "speed [rad/s]")
    for found, color, dashes, marker in _shown(steady):
        _residuals(under, steady, found.speed_residual_rad_s.by_row, (found.name, color, marker + dashes))
    finished(under, "model less measured", "voltage [V]", "speed [rad/s]")


def _currents(over: Axes, under: Axes, steady: SteadyBench) -> None:
    for found, color, dashes, _ in _shown(steady):
        over.plot(found.curve.voltage_V, _milli(found.curve.current_A), dashes, color=color, label=found.name)
    over.plot(steady.voltage_V, _milli(steady.measured_current_A), "o", color=BLACK, ms=4, label="measured (Table 1)")
    finished(over, "Steady state: current (paper Fig. 10)", "voltage [V]", "current [mA]")
    for found, color, dashes, marker in _shown(steady):
        _residuals(under, steady, _milli(found.current_residual_A.by_row), (found.name, color, marker + dashes))
    finished(under, "model less measured", "voltage [V]", "current [mA]")


def _shown(steady: SteadyBench) -> tuple[tuple[Candidate, str, str, str], ...]:
    """With colour, dashes and marker; where the robot is nominal, its motor is the literal fit."""
    return (
        (steady.robot, BLUE, "-", "o"),
        (steady.printed_variant, VERMILION, "--", "s"),
        (steady.table_2, GREEN, ":", "^"),
    )


def _residuals(axes: Axes, steady: SteadyBench, by_row: Sequence[float], style: tuple[str, str, str]) -> None:
    name, color, line = style
    axes.axhline(0.0, color=GREY, lw=0.8)
    axes.plot(steady.voltage_V, by_row, line, color=color, ms=3, lw=1, label=name)


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
