"""Demands of a scenario on its robot, before anything is simulated, beside the ranges in which it was measured.

The built-in controller has its speeds and yaw rates as settings. Speeds and steady voltages of the wheels follow from
them by the equations of the drive and the motor, and the readings of the range sensors from the size of the arena. What
the robot really does is known after a run, which `run_warnings/observed_range.py` looks at.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot

from configs.posterior.schema import LoadedPosterior, MeasuredRange
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from pipeline.run_warnings.observed_range import MARGIN, within
from symolo.core.yaml.tree import dotted

_V = (
    ("line", "k1_m_s"),
    ("wall", "gains", "k1_m_s"),
    ("avoidance", "speed_m_s"),
    ("lost", "speed_m_s"),
)
_W = (
    ("corner", "turn_rate_rad_s"),
    ("avoidance", "curves", "turn_rate_rad_s"),
    ("avoidance", "curves", "face", "turn_rate_rad_s"),
    ("lost", "turn_rate_rad_s"),
)


@dataclass(frozen=True)
class Demand:
    """Largest or smallest value of one quantity in the runs of a scenario."""

    quantity: str
    value: float
    cause: str
    """Setting that it comes from."""


def source_line(like: LoadedPosterior | None, replaced_draws: Sequence[str] = ()) -> str:
    """Return the measurement that the robots come from, with its hypotheses and their weights; empty without one.

    Args:
        like: Posterior of the scenario.
        replaced_draws: Fields that the scenario draws, and that come from the posterior instead.
    """
    if like is None:
        return ""
    names = ", ".join(f"{each.name} {100.0 * each.weight:.3g} %" for each in like.hypotheses)
    none = f"{100.0 * like.something_else:.3g} %"
    instead = f"; in place of what the scenario draws: {', '.join(replaced_draws)}" if replaced_draws else ""
    return f"like {like.source}: {names}; probability that the truth is something else {none}{instead}"


def demand_lines(like: LoadedPosterior | None, specs: Sequence[RunSpec]) -> tuple[str, ...]:
    """Return a line for each quantity whose measured range a scenario leaves; nothing without a posterior.

    Args:
        like: Posterior of the scenario.
        specs: Its runs.
    """
    if like is None:
        return ()
    demands = [demand for spec in specs for demand in demands_of(spec)]
    measured = {each.quantity: each for each in like.measured if each.quantity is not None}
    lines = []
    for quantity in dict.fromkeys(demand.quantity for demand in demands):
        of_quantity = [demand for demand in demands if demand.quantity == quantity]
        if quantity not in measured:
            highest = max(of_quantity, key=lambda demand: demand.value)
            lines.append(f"{quantity} was not measured; the scenario demands up to {_text(highest)}")
        else:
            lines += _beyond(measured[quantity], of_quantity)
    return tuple(lines)


def _beyond(measured: MeasuredRange, demands: Sequence[Demand]) -> Iterator[str]:
    low, high = within(str(measured.quantity), measured.low, measured.high)
    margin = MARGIN * (measured.high - measured.low)
    ends = (min(demands, key=lambda demand: demand.value), max(demands, key=lambda demand: demand.value))
    outside = [end for end in ends if not low - margin <= end.value <= high + margin]
    if outside:
        demanded = " and ".join(_text(end) for end in dict.fromkeys(outside))
        yield f"{measured.quantity} was measured from {measured.low:.3g} to {measured.high:.3g}; demanded: {demanded}"


def _text(demand: Demand) -> str:
    return f"{demand.value:.3g} ({demand.cause})"


def demands_of(spec: RunSpec) -> Iterator[Demand]:
    """Yield what one run demands of the quantities that a diagnosis measures."""
    robot = spec.robot
    if spec.board is None and spec.controller is None:
        yield from _of_controller(robot)
    tof, arena = robot.tof, spec.arena
    points = [(x, y) for wall in arena.walls for x, y in (wall.start, wall.end)]
    points += [box.center for box in arena.obstacles]
    if points:
        across_m = hypot(*(max(axis) - min(axis) for axis in zip(*points, strict=True)))
        yield Demand("tof_m", min(tof.max_range_m, across_m), "the size of the arena")
        yield Demand("tof_m", tof.min_range_m, "robot.tof.min_range_m")


def _of_controller(robot: RobotConfig) -> Iterator[Demand]:
    motor, radius_m = robot.motor, 0.5 * robot.drive.wheel_diameter_m
    constant = motor.torque_constant_N_m_A
    volts_per_N_m = motor.winding_resistance_ohm / constant
    for quantity, paths, arm_m in (("v_m_s", _V, 1.0), ("w_rad_s", _W, 0.5 * robot.drive.track_m)):
        for path in paths:
            value: object = robot.controller
            for key in path:
                value = getattr(value, key, None)
            if not isinstance(value, float):
                continue
            cause = f"robot.controller.{dotted(path)}"
            wheel_rad_s = value * arm_m / radius_m
            friction_N_m = motor.viscous_friction_N_m_s_rad * wheel_rad_s + motor.coulomb_friction_N_m
            volts = constant * wheel_rad_s + volts_per_N_m * friction_N_m  # paper Eq. 15-17 at a constant speed
            signs = (1.0,) if quantity == "v_m_s" else (1.0, -1.0)
            for sign in signs:
                yield Demand(quantity, sign * value, cause)
                yield Demand("wheel_speed_rad_s", sign * wheel_rad_s, cause)
                yield Demand("voltage_V", sign * min(volts, robot.power.motor_voltage_limit_V), cause)
