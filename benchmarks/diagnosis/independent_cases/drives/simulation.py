"""The true robot in closed loop: commands, wheel-speed controller, motors, slip, pose and encoder counts."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.diagnosis.independent_cases.drives.effects import (
    Geometry,
    body_motion,
    counted,
    true_geometry,
    wheel_travel,
)
from benchmarks.diagnosis.independent_cases.drives.robot import Robot
from benchmarks.diagnosis.independent_cases.drives.wheels import (
    FINE_S,
    ROW_S,
    SUB,
    in_disc,
    substep,
    supply_terms,
    wheel_laws,
)
from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes
from benchmarks.diagnosis.independent_cases.recipes import Array, Variant

if TYPE_CHECKING:
    from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting

FREE, TURNING, RETURNING = 0, 1, 2

MIN_PART_S = 1e-9  # shorter parts of a sub-step are rounding errors


@dataclass(frozen=True)
class Run:
    """The true run of all trials and of the unseen one; rows are 50 ms apart and fine steps 10 ms."""

    u_V: Array  # (trials, rows - 1, 2), logged voltages
    commands: Array  # (trials, rows, 2), speed [m/s] and yaw rate [rad/s]
    counts: Array  # (trials, rows, 2), whole ticks
    poses: Array  # (trials, fine steps + 1, 3), x [m], y [m], yaw [rad]
    angles: Array  # (trials, fine steps + 1, 2), wheel angles [rad]


class _Driver:
    """Follows the script, and turns back to the middle of the room before a wall."""

    def __init__(self, setting: "DriveSetting") -> None:
        self.script, self.robot, self.away_rows = setting.script, setting.robot, setting.away_rows
        trials = len(self.script)
        self.state, self.until = np.zeros(trials, int), np.zeros(trials, int)

    def command(self, pose: Array, k: int) -> tuple[Array, Array]:
        """Return speed (m/s) and yaw rate (rad/s) of all trials in row k."""
        robot = self.robot
        v, turn = self.script[:, k, 0], self.script[:, k, 1]
        error = self._watch_walls(pose, v, k)
        turning, returning = self.state == TURNING, self.state == RETURNING
        v = np.where(turning, 0.0, np.where(returning, 0.6 * robot.top_speed_m_s, v))
        back = np.sign(error) * np.minimum(robot.turn_rate_rad_s, 0.5 + 2 * np.abs(error))
        turn = np.where(turning, back, np.where(returning, np.clip(error, -0.5, 0.5), turn))
        return np.round(v, 3), np.round(turn, 3)

    def _watch_walls(self, pose: Array, v: Array, k: int) -> Array:
        """Update what the trials do, and return the angle (rad) to the middle of the room."""
        margin, size = 0.8 * self.robot.track_m + 0.02, np.array(self.robot.room)
        ahead = pose[:, :2] + 0.45 * v[:, None] * np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=1)
        outside = np.any((ahead < margin) | (ahead > size - margin), axis=1)
        to_middle = np.arctan2(size[1] / 2 - pose[:, 1], size[0] / 2 - pose[:, 0])
        error = (to_middle - pose[:, 2] + np.pi) % (2 * np.pi) - np.pi
        self.state = np.where((self.state != TURNING) & outside & (np.abs(error) > 0.9), TURNING, self.state)
        done = (self.state == TURNING) & (np.abs(error) < 0.3)
        self.until = np.where(done, k + self.away_rows, self.until)
        self.state = np.where(done, RETURNING, self.state)
        self.state = np.where((self.state == RETURNING) & (k >= self.until), FREE, self.state)
        return error


class _Controller:
    """Wheel-speed controller: feed-forward of the nominal motor, proportional and integral part."""

    def __init__(self, robot: Robot, trials: int) -> None:
        self.robot, self.integral = robot, np.zeros((trials, 2))

    def volts(self, v: Array, turn: Array, measured: Array) -> Array:
        """Return the voltages (V) for speed (m/s) and yaw rate (rad/s) beside measured wheel speeds (rad/s)."""
        robot, motor = self.robot, self.robot.motor
        resistance, constant, viscous, coulomb = (motor.value(key) for key in ("R", "K", "B", "Tc"))
        track, radius, supply = robot.track_m, robot.radius_m, motor.supply_V
        target = np.stack([v - turn * track / 2, v + turn * track / 2], axis=1) / radius
        lack = target - measured
        self.integral = np.clip(self.integral + 1.5 * constant * ROW_S * lack, -0.3 * supply, 0.3 * supply)
        drag = viscous * target + coulomb * np.tanh(target / (0.05 * robot.top_speed_m_s / radius))
        volts = constant * target + resistance / constant * drag + 0.4 * constant * lack + self.integral
        return np.round(np.clip(volts, -supply, supply), 3)


def _delayed(u: Array, k: int, m: int, delay_s: float) -> Iterator[tuple[Array, float]]:
    """Yield the voltages (trials, 2) that act in the parts of sub-step m of row k, and the durations (s) of the parts.

    Commands act later by a delay. A mean voltage over the sub-step would act like a lag.
    """
    end = k * ROW_S + (m + 1) * FINE_S - delay_s
    begin = end - FINE_S
    past = int(np.ceil(delay_s / ROW_S + 1e-9))
    for i in range(k - past - 1, k + 1):
        overlap = min(end, (i + 1) * ROW_S) - max(begin, i * ROW_S)
        if overlap > MIN_PART_S:
            yield (u[:, i] if i >= 0 else np.zeros_like(u[:, 0])), overlap


class _Body:
    """Both motors, the body and the encoders of all trials."""

    def __init__(self, setting: "DriveSetting", variant: Variant) -> None:
        self.setting, self.variant = setting, variant
        trials = len(setting.session_s)
        self.lanes = Lanes.stack([law for t in range(trials) for law in wheel_laws(setting, variant, t, None)])
        self.varies, self.p = self.lanes.varies, self.lanes.column(0)
        terms = [supply_terms(setting, variant, t) for t in range(trials)]
        self.delay_s = terms[0][0]
        self.sources = np.repeat([term[1] for term in terms], 2) if terms[0][1] > 0 else None
        self.battery = np.repeat(np.stack([term[2] for term in terms]), 2, axis=0)
        self.patch = dict(variant.outside).get("friction_patch")
        self.w, self.angle = np.zeros(trials * 2), np.zeros(trials * 2)
        self.pose, self.counts = setting.start.copy(), np.zeros((trials, 2))
        self.geometry = self._geometry(0)

    def _geometry(self, k: int) -> Geometry:
        """Return the geometry at row k."""
        session = self.setting.session_s[:, k]
        return true_geometry(self.setting.individual, self.variant.effects, self.variant.outside, session)

    def start_row(self, k: int) -> None:
        """Take over what changes from row to row."""
        if self.varies or self.patch is not None:
            self.p = self.lanes.column(k)
        if "geometry_jump" in dict(self.variant.outside):
            self.geometry = self._geometry(k)
        if self.patch is not None:
            inside = in_disc(self.pose[:, 0], self.pose[:, 1], self.patch)
            self.p.Tc = self.p.Tc * np.repeat(np.where(inside, 1 + self.patch["change"], 1.0), 2)

    def step(self, u: Array, k: int, m: int, torque: Array, slip: Array) -> None:
        """Go on by one fine step with the voltages of all rows so far, a random torque (N m) and random slip."""
        turned = np.zeros_like(self.angle)
        for now, h in _delayed(u, k, m, self.delay_s) if self.delay_s > 0 else ((u[:, k], FINE_S),):
            command, angle = now.reshape(-1) * self.battery[:, k], self.angle + turned
            self.w, more = substep(self.p, command, self.w, angle, sources=self.sources, torque=torque, h=h)
            turned = turned + more
        pairs = turned.reshape(-1, 2)
        middle = self.angle.reshape(-1, 2) + 0.5 * pairs
        self.angle = self.angle + turned
        x, y, theta = self.pose.T
        travel = wheel_travel(self.geometry, pairs, middle, x, y)
        travel = travel + slip * np.sqrt(np.abs(travel))
        ds, spun, creep_x, creep_y = body_motion(self.geometry, travel, FINE_S)
        heading = theta + 0.5 * spun
        x, y = x + ds * np.cos(heading) + creep_x, y + ds * np.sin(heading) + creep_y
        self.pose = np.stack([x, y, theta + spun], axis=1)
        self.counts += counted(self.variant.effects, pairs, FINE_S, self.setting.robot.ticks)


def simulate(setting: "DriveSetting", variant: Variant) -> Run:
    """Return the true run of that robot; the same setting has the same disturbances for every variant."""
    rng = np.random.default_rng(setting.loop_seed)
    trials, rows = setting.session_s.shape
    fine = (rows - 1) * SUB
    torque = setting.wheel.torque_sd_N_m * rng.standard_normal((rows - 1, trials * 2))
    slip = setting.travel_noise * rng.standard_normal((fine, trials, 2))
    phase = rng.random((trials, 2))
    driver, controller, body = _Driver(setting), _Controller(setting.robot, trials), _Body(setting, variant)
    counts, before = np.zeros((trials, rows, 2), int), np.zeros((trials, 2), int)
    u, commands = np.zeros((trials, rows - 1, 2)), np.zeros((trials, rows, 2))
    poses, angles = np.zeros((fine + 1, trials, 3)), np.zeros((fine + 1, trials, 2))
    poses[0] = body.pose
    for k in range(rows - 1):
        v, turn = driver.command(body.pose, k)
        commands[:, k, 0], commands[:, k, 1] = v, turn
        measured = (counts[:, k] - before) * (2 * np.pi / setting.robot.ticks / ROW_S)
        before = counts[:, k].copy()
        u[:, k] = controller.volts(v, turn, measured)
        body.start_row(k)
        for m in range(SUB):
            step = k * SUB + m
            body.step(u, k, m, torque[k], slip[step])
            poses[step + 1], angles[step + 1] = body.pose, body.angle.reshape(trials, 2)
        counts[:, k + 1] = np.floor(body.counts + phase) - np.floor(phase)
    commands[:, -1] = np.nan
    return Run(u, commands, counts, poses.transpose(1, 0, 2), angles.transpose(1, 0, 2))
