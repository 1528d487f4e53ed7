"""Effects of drive logs outside the motor: geometry, encoders, tracked marker and range sensors."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform
from benchmarks.diagnosis.independent_cases.drives.robot import Robot
from benchmarks.diagnosis.independent_cases.drives.wheels import SIDES, in_disc
from benchmarks.diagnosis.independent_cases.motors.motor_effects import PLACES
from benchmarks.diagnosis.independent_cases.recipes import Array, Draft, Effect, Parameters, Recipe

MOTOR_NAMES = (
    "winding_resistance_scale",
    "torque_constant_scale",
    "torque_constant_mismatch",
    "viscous_friction_scale",
    "coulomb_friction_scale",
    "rotor_inertia_scale",
    "bridge_voltage_drop",
    "supply_sag",
    "battery_decline",
    "input_delay",
    "bridge_coast",
)


@dataclass(frozen=True)
class DriveDraft(Draft):
    """A draft with what the plausible sizes depend on."""

    sensor: str
    wheel: str
    phase_rad: float
    robot: Robot
    second_session: int | None  # its first trial, if there is one
    trials: int  # with the unseen one


def _missed_ticks(d: DriveDraft) -> Recipe:
    threshold = d.robot.wheel_speed_rad_s * d.rng.uniform(0.25, 0.7)
    return d.positive(2e-3, 0.4, "fraction", {"side": d.wheel}, threshold_rad_s=threshold)


def _turn_slip(d: DriveDraft) -> Recipe:
    """Size is the share of the turn that is lost at three tenths of the highest speed and yaw rate."""
    typical = 0.3 * d.robot.top_speed_m_s * d.robot.turn_rate_rad_s
    return d.grows(3e-3, 1.0, lambda size: {"coefficient_s2_m": size / typical})


def _marker_yaw(d: DriveDraft) -> Recipe:
    if d.second_session is None:
        return d.signed(2e-3, 0.2, "angle_rad")
    other, second = d.rng.uniform(-1, 0.6), d.second_session

    def angles(size: float) -> Parameters:
        angle = d.direction * size
        return {
            "angle_rad": angle,
            "angle_by_trial_rad": [angle * (1.0 if trial < second else other) for trial in range(d.trials)],
        }

    return d.grows(2e-3, 0.2, angles)


RECIPES: dict[str, tuple[str, Callable[[DriveDraft], Recipe]]] = {
    "wheel_radius_scale": ("radius", lambda d: d.scaled(1e-3, 0.2)),
    "wheel_radius_asymmetry": ("turning", lambda d: d.signed(3e-4, 0.1, "asymmetry")),
    "wheelbase_scale": ("turning", lambda d: d.scaled(1e-3, 0.2)),
    "encoder_ticks_scale": ("radius", lambda d: d.scaled(1e-3, 0.2)),
    "encoder_missed_ticks": ("encoder", _missed_ticks),
    "turn_slip": ("turning", _turn_slip),
    "marker_offset": ("marker", lambda d: d.signed(5e-4, 0.25 * d.robot.track_m, "offset_m")),
    "pose_time_offset": ("pose_clock", lambda d: d.positive(2e-3, 0.3, "delay_s")),
    "tof_range_offset": ("range", lambda d: d.signed(1e-3, 0.1, "offset_m", {"sensor": d.sensor})),
    "tof_range_scale": ("range", lambda d: d.scaled(1e-3, 0.2)),
    "tof_mount_yaw": ("mount", lambda d: d.signed(2e-3, 0.3, "angle_rad", {"sensor": d.sensor})),
    "tof_time_offset": ("range_clock", lambda d: d.positive(3e-3, 0.35, "delay_s")),
    "marker_yaw": ("marker", _marker_yaw),
    "pose_clock_drift": ("pose_clock", lambda d: d.positive(1e-4, 0.02, "rate")),
    "wheel_eccentricity": (
        "wheel",
        lambda d: d.positive(2e-3, 0.2, "amplitude", {"side": d.wheel}, phase_rad=d.phase_rad),
    ),
    "floor_slope": ("floor", lambda d: d.positive(1e-3, 0.15, "gradient", direction_rad=d.phase_rad)),
    "range_gathering_time": ("range_clock", lambda d: d.positive(0.01, 0.5, "duration_s")),
    "range_wander": ("range", lambda d: d.positive(3e-4, 0.05, "sd_m", time_constant_s=log_uniform(d.rng, 1, 20))),
}
"""Place and recipe of every listed effect outside the motor."""
PLACE = {name: PLACES[name] for name in MOTOR_NAMES} | {name: place for name, (place, _) in RECIPES.items()}


@dataclass
class Geometry:
    """True geometry of the robot; lengths may be arrays over trials (and time)."""

    left_m: Any  # wheel radius
    right_m: Any
    track_m: Any
    slip_s2_m: float = 0.0
    slope: float = 0.0
    slope_direction_rad: float = 0.0
    eccentric: dict[str, tuple[float, float]] = field(default_factory=dict)  # amplitude, phase [rad] per side
    patch: dict[str, float] | None = None  # slippery disc of the floor


def true_geometry(
    individual: dict[str, float], effects: Sequence[Effect], outside: Sequence[Effect], session_s: Array | float
) -> Geometry:
    """Return the geometry with the effects; session_s are session times for changes in time."""
    g = Geometry(individual["radius"], individual["radius"], individual["track"])
    listed, unlisted = dict(effects), dict(outside)
    if "wheel_radius_scale" in listed:
        scale = listed["wheel_radius_scale"]["scale"]
        g.left_m, g.right_m = g.left_m * scale, g.right_m * scale
    if "wheel_radius_asymmetry" in listed:
        half = listed["wheel_radius_asymmetry"]["asymmetry"] / 2
        g.left_m, g.right_m = g.left_m * (1 + half), g.right_m * (1 - half)
    if "wheelbase_scale" in listed:
        g.track_m = g.track_m * listed["wheelbase_scale"]["scale"]
    g.slip_s2_m = listed.get("turn_slip", {"coefficient_s2_m": 0.0})["coefficient_s2_m"]
    if "wheel_eccentricity" in listed:
        p = listed["wheel_eccentricity"]
        g.eccentric[p["side"]] = (p["amplitude"], p["phase_rad"])
    if "floor_slope" in listed:
        g.slope, g.slope_direction_rad = listed["floor_slope"]["gradient"], listed["floor_slope"]["direction_rad"]
    if "geometry_jump" in unlisted:
        p = unlisted["geometry_jump"]
        factor = np.where(session_s >= p["time_s"], 1 + p["change"], 1.0)
        if p["parameter"] == "track":
            g.track_m = g.track_m * factor
        else:
            g.left_m, g.right_m = g.left_m * factor, g.right_m * factor
    g.patch = unlisted.get("slippery_patch")
    return g


def wheel_travel(g: Geometry, turned: Array, angle: Array, x: Array, y: Array) -> Array:
    """Return the travel (m) of both wheels (..., 2) over a short turn (rad) around a wheel angle (rad) at x, y (m)."""
    travel = np.stack([g.left_m * turned[..., 0], g.right_m * turned[..., 1]], axis=-1)
    for i, side in enumerate(SIDES):
        if side in g.eccentric:
            amplitude, phase = g.eccentric[side]
            travel[..., i] *= 1 + amplitude * np.cos(angle[..., i] + phase)
    if g.patch is not None:
        travel = travel * np.where(in_disc(x, y, g.patch), 1 - g.patch["lost_share"], 1.0)[..., None]
    return travel


def body_motion(g: Geometry, travel: Array, h: float) -> tuple[Array, Array, Array, Array]:
    """Return forward motion (m), turn (rad) and creep along x and y (m) over h seconds from the wheels' travel (m)."""
    ds = 0.5 * (travel[..., 0] + travel[..., 1])
    turn = (travel[..., 1] - travel[..., 0]) / g.track_m
    turn = turn / (1 + g.slip_s2_m * np.abs(ds / h * turn / h))
    creep = g.slope * np.abs(ds)
    return ds, turn, creep * np.cos(g.slope_direction_rad), creep * np.sin(g.slope_direction_rad)


def counted(effects: Sequence[Effect], turned: Array, h: float, ticks: float) -> Array:
    """Return encoder counts before rounding for short turns (..., 2) in rad over h seconds."""
    counts = turned * ticks / (2 * np.pi)
    for name, p in effects:
        if name == "encoder_ticks_scale":
            counts = counts * p["scale"]
        elif name == "encoder_missed_ticks":
            i = SIDES.index(p["side"])
            speed = np.abs(turned[..., i]) / h
            edge = 1 / (1 + np.exp(-np.clip((speed - p["threshold_rad_s"]) / 0.3, -60, 60)))
            counts = counts.copy()
            counts[..., i] *= 1 - p["fraction"] * edge
    return counts
