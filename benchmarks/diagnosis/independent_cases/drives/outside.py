"""Effects of drive logs that the format does not list."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick
from benchmarks.diagnosis.independent_cases.drives.robot import SENSORS, Robot
from benchmarks.diagnosis.independent_cases.drives.wheels import SIDES
from benchmarks.diagnosis.independent_cases.recipes import Draft, Recipe

WHEELS = ("friction_patch", "friction_jump", "wheel_cogging", "command_dead_zone")


@dataclass(frozen=True)
class OutsideDraft(Draft):
    """A draft with what the plausible sizes depend on."""

    robot: Robot
    span_s: float  # session time of the last row
    when_s: float  # moment of a jump
    phase_rad: float
    disc: dict[str, float]  # middle and radius [m] of a patch of the floor


def draw_disc(rng: np.random.Generator, robot: Robot) -> dict[str, float]:
    """Draw a disc of the floor (m) about in the middle of the room."""
    room_x, room_y = robot.room
    return {
        "x_m": room_x * rng.uniform(0.35, 0.65),
        "y_m": room_y * rng.uniform(0.35, 0.65),
        "radius_m": min(room_x, room_y) * rng.uniform(0.12, 0.25),
    }


def _wheel_cogging(d: OutsideDraft) -> Recipe:
    wheel, cycles, tc = pick(d.rng, SIDES), float(pick(d.rng, [1, 2, 3])), d.robot.motor.value("Tc")
    shape = {"cycles_per_turn": cycles, "phase_rad": d.phase_rad}
    return d.grows(0.03, 0.9, lambda size: {"side": wheel, "amplitude_N_m": size * tc, **shape}).seen_in(
        "wheel_speed_rad_s", "wheel_angle_rad", "one wheel's load torque swings with its angle"
    )


def _geometry_jump(d: OutsideDraft) -> Recipe:
    key = pick(d.rng, ["track", "radius"])
    recipe = d.signed(1e-3, 0.2, "change", {"parameter": key}, time_s=d.when_s)
    text = f"the {key} changes by a factor at one moment of the session"
    return recipe.seen_in("pose_increment", "session_time_s", text)


RECIPES: dict[str, Callable[[OutsideDraft], Recipe]] = {
    "friction_patch": lambda d: d.positive(0.05, 3.0, "change", d.disc).seen_in(
        "wheel_speed_rad_s", "position", "Coulomb friction is higher in one disc of the floor"
    ),
    "friction_jump": lambda d: d.positive(0.03, 1.2, "change", time_s=d.when_s).seen_in(
        "wheel_speed_rad_s", "session_time_s", "Coulomb friction jumps at one moment of the session"
    ),
    "wheel_cogging": _wheel_cogging,
    "command_dead_zone": lambda d: d.grows(0.02, 0.5, lambda size: {"below_V": size * d.robot.motor.supply_V}).seen_in(
        "wheel_speed_rad_s", "u_left_V", "voltages below a threshold do nothing, others act in full"
    ),
    "slippery_patch": lambda d: d.positive(3e-3, 0.5, "lost_share", d.disc).seen_in(
        "pose_increment", "position", "wheels lose a share of their travel in one disc of the floor"
    ),
    "geometry_jump": _geometry_jump,
    "heading_distortion": lambda d: d.positive(1e-3, 0.12, "amplitude_rad", phase_rad=d.phase_rad).seen_in(
        "pose_increment", "theta_rad", "the tracked heading has an error with twice the heading"
    ),
    "glass_wall": lambda d: d.positive(2e-3, 0.25, "extra_m", {"wall": int(d.rng.integers(4))}).seen_in(
        "tof_m", "wall", "one wall reads too far"
    ),
    "range_periodic": lambda d: d.positive(
        5e-4, 0.06, "amplitude_m", wavelength_m=log_uniform(d.rng, 0.05, 0.3), phase_rad=d.phase_rad
    ).seen_in("tof_m", "distance_m", "all ranges have an error periodic in distance"),
    "range_memory": lambda d: d.positive(0.02, 0.7, "share", {"sensor": pick(d.rng, SENSORS)}).seen_in(
        "tof_m", "previous_distance_m", "one sensor mixes a share of its previous reading into the new one"
    ),
    "range_gain_drift": lambda d: d.signed(1e-3, 0.15, "change", span_s=d.span_s).seen_in(
        "tof_m", "session_time_s", "the scale of all ranges drifts linearly over the session"
    ),
}
