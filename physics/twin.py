"""The robot without an engine: the same chain from voltages to poses and counts, for many trials of one robot at once.

Motors take exact steps, wheels roll without slip, and the path of each step is an arc. Wheel speeds are computed step
by step; voltages, poses and counts of all steps at once. In contrast to PyBullet there are no contacts with walls, no
sliding wheels, no tilting, and no shift of load between wheels and caster.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from physics.arena.rays import RayHits, RayScene
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.motion import voltage_trend
from physics.drivetrain.motor import HeldWheel
from physics.drivetrain.motor_arrays import HeldDrive
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.drivetrain.wheel_slip import WheelSlip
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.body_motion import BodyMotion
from physics.robot.floor_place import FloorPlace
from physics.robot.model import RobotModel, applied
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array, stacked_rows
from symolo.core.finite import require_finite
from symolo.core.geometry.poses import PlanarPose, pose_X_WR

MAX_SCALAR_TRIALS = 16
"""Number of trials of bare motors up to which a loop over plain floats is faster than arrays."""


@dataclass(frozen=True)
class TwinRun:
    """N trials at T + 1 times; wheels are right and left."""

    t_s: Array
    """(T + 1,), [s]."""
    pose: Array
    """(T + 1, N, 3), x [m], y [m], yaw [rad] in W, yaw unwrapped."""
    wheel_speed_rad_s: Array
    """(T + 1, N, 2), true wheel speeds."""
    current_A: Array
    """(T + 1, N, 2), winding currents at the voltage of the previous step."""
    counts: NDArray[np.int64]
    """(T + 1, N, 2), encoder counts since the start."""


class KinematicTwin:
    """Open-loop drives of one robot.

    Raises:
        InputError: The robot has play in its gears.
    """

    def __init__(self, model: RobotModel, step_s: float = 0.005, rng: np.random.Generator | None = None) -> None:
        """Prepare drives in steps of a duration [s]; without random numbers, no wheel slips at random."""
        model.require_rigid_gears("the twin")
        self._step_s = step_s
        self._limit_V = voltage_limit_V(model.config.power)
        self._driveline = Driveline.of_robot(model)
        self._body = BodyOnWheels.from_model(model)
        inertia = self._body.wheel_inertia_kg_m2
        self._inertia = np.diag(inertia) + self._driveline.inertia_kg_m2
        self._coupling = inertia - np.diag(np.diag(inertia))
        self._delay_steps = round(model.input_delay_s / step_s)
        self._counting = model.functions(Slot.COUNTING)
        self._rolling = model.functions(Slot.ROLLING)
        self._slip = WheelSlip(model, rng)
        self._radius_m = np.array([model.geometry.right_radius_m, model.geometry.left_radius_m])
        self._creep = model.functions(Slot.CREEP)
        self._ground = model.functions(Slot.GROUND)
        self._travel = model.functions(Slot.TRAVEL)
        self._turning = model.functions(Slot.TURNING)
        self._needs_place = bool(self._driveline.needs_place or self._travel or self._turning)
        self._counts_per_rad = model.counts_per_revolution / (2.0 * pi)

    def drive(self, voltages_V: Array, starts: Array) -> TwinRun:
        """Return open-loop drives from rest.

        Args:
            voltages_V: (T, N, 2), right and left, each constant for one step.
            starts: (N, 3), poses at the start, x [m], y [m], yaw [rad].

        Raises:
            ValueError: A voltage is not a finite number.
        """
        require_finite(voltages_V, "voltages_V", ("step", "trial", "wheel"))
        steps, lanes, _ = voltages_V.shape
        commands = np.clip(voltages_V, -self._limit_V, self._limit_V)
        late = np.zeros((min(self._delay_steps, steps), lanes, 2))
        commands = np.concatenate([late, commands[: steps - len(late)]])
        voltage, speed, turned = (np.zeros((steps + 1, lanes, 2)) for _ in range(3))
        voltage[1:] = self._voltages(commands)
        heat = self._heat(voltage[1:])
        time_s = np.arange(-1, steps)[:, None, None] * self._step_s
        supply = np.broadcast_to(self._driveline.supply_V(time_s), time_s.shape)
        place = np.zeros((steps + 1, lanes, 2))
        if self._driveline.is_bare and lanes <= MAX_SCALAR_TRIALS and not self._needs_place:
            for lane in range(lanes):
                speed[1:, lane], turned[1:, lane] = self._turned_alone(voltage[1:, lane])
        else:
            speed[1:], turned[1:], place[1:] = self._turned_together(
                starts, voltage[1:], supply[1:], voltage_trend(commands), heat
            )
        counted = np.cumsum(applied(self._counting, turned, self._step_s), axis=0)
        return TwinRun(
            t_s=np.arange(steps + 1) * self._step_s,
            pose=self._path(starts, turned, place),
            wheel_speed_rad_s=speed,
            current_A=self._driveline.current_A(voltage, speed, supply, self._driveline.winding(time_s, heat)),
            counts=np.floor(counted * self._counts_per_rad + 0.5).astype(np.int64),
        )

    def _voltages(self, commands_V: Array) -> Array:
        """Return the voltages at the motors at every step, (T, N, 2)."""
        time_s = np.arange(len(commands_V)) * self._step_s
        if not self._driveline.lags:
            return self._driveline.voltage_V(commands_V, commands_V, time_s[:, None, None], self._step_s)[1]
        held, voltage_V = np.zeros(commands_V.shape[1:]), np.zeros_like(commands_V)
        for k, command_V in enumerate(commands_V):
            held, voltage_V[k] = self._driveline.voltage_V(held, command_V, float(time_s[k]), self._step_s)
        return voltage_V

    def _heat(self, voltage_V: Array) -> Array:
        """Return the share by which heat has raised the resistance before the first step and after each, (T + 1, ...).

        Without such an effect it is one number for all steps.
        """
        heats: list[float | Array] = [0.0]
        for volts in voltage_V if self._driveline.heats else ():
            heats.append(self._driveline.heat_after(heats[-1], volts, self._step_s))
        return stacked_rows(heats) if len(heats) > 1 else np.zeros((1, 1, 1))

    def _turned_together(
        self, starts: Array, voltage_V: Array, supply_V: Array, trend: Array, heat: Array
    ) -> tuple[Array, Array, Array]:
        """Return speeds after each step, angles turned in it, and places before it, (T, N, 2) each, at the supply's
        voltages (T, 1, 1). The places are those at the starts, if nothing depends on them.

        The coupling between the wheels uses the acceleration of the previous step.
        """
        driveline, body = self._driveline, self._body
        speeds, turned, places = (np.zeros_like(voltage_V) for _ in range(3))
        speed = acceleration = angle = np.zeros(voltage_V.shape[1:])
        pose = starts
        for k, stall in enumerate(driveline.stall_torque_N_m(voltage_V)):
            time_s = k * self._step_s
            winding = driveline.winding(time_s, heat[k] if driveline.heats else 0.0)
            torque = stall + driveline.extra_torque_N_m(voltage_V[k], speed, supply_V[k], winding)
            places[k] = pose[:, :2]
            friction = driveline.friction_N_m(torque, speed, time_s, trend[k], (pose[:, :1], pose[:, 1:2]))
            # The body couples the wheels: the acceleration of each one loads the other.
            torque = torque - acceleration @ self._coupling
            load_right, load_left = body.load_N_m(speed[:, 0], speed[:, 1])
            torque[:, 0] += load_right
            torque[:, 1] += load_left
            torque = driveline.shaft_torque_N_m(torque, angle, self._step_s * speed)
            held = HeldDrive(torque, driveline.damping_N_m_s_rad, friction, self._inertia)
            speeds[k], turned[k] = held.step(speed, self._step_s)
            acceleration = (speeds[k] - speed) / self._step_s
            if self._needs_place:
                pose = self._moved(pose, turned[k], angle, time_s)
            speed, angle = speeds[k], angle + turned[k]
        return speeds, turned, places

    def _turned_alone(self, voltage_V: Array) -> tuple[Array, Array]:
        """Return speeds and angles as `_turned_together`, for one trial of motors whose torque no effect changes."""
        driveline, load_N_m, step_s = self._driveline, self._body.load_N_m, self._step_s
        numbers = np.stack([driveline.damping_N_m_s_rad, driveline.coulomb_N_m, self._inertia], axis=1).tolist()
        step_right, step_left = (HeldWheel(*wheel, duration_s=step_s).step for wheel in numbers)
        coupling = float(self._coupling[0, 1])
        right = left = faster_right = faster_left = 0.0
        rows = []
        for stall_right, stall_left in driveline.stall_torque_N_m(voltage_V).tolist():
            load_right, load_left = load_N_m(right, left)
            row = (
                *step_right(stall_right + load_right - coupling * faster_left, right),
                *step_left(stall_left + load_left - coupling * faster_right, left),
            )
            faster_right, faster_left = (row[0] - right) / step_s, (row[2] - left) / step_s
            right, left = row[0], row[2]
            rows.append(row)
        both = np.array(rows).reshape(-1, 2, 2)
        return both[..., 0], both[..., 1]

    def _moved(self, pose: Array, turned_rad: Array, angle_rad: Array, time_s: float) -> Array:
        """Return the poses (N, 3) after one step, without random slip: the places on which the next step depends."""
        place = FloorPlace(pose[:, :1], pose[:, 1:2], time_s)
        turned_rad = self._over_floor(turned_rad, angle_rad + 0.5 * turned_rad, place)
        forward_m, turn_rad = self._arcs(turned_rad, place)
        middle_rad = pose[:, 2] + 0.5 * turn_rad
        moved_m = forward_m[:, None] * np.stack([np.cos(middle_rad), np.sin(middle_rad)], axis=-1)
        if self._creep:
            moved_m = moved_m + self._crept(turned_rad)
        return pose + np.concatenate([moved_m, turn_rad[:, None]], axis=-1)

    def _crept(self, turned_rad: Array) -> Array:
        """Return how far the body creeps over the floor, x, y [m] in W (..., 2), by the travels of round wheels."""
        rolled_m, middle_m = (size @ self._body.to_twist[0] for size in (np.abs(turned_rad), turned_rad))
        still = np.zeros((*rolled_m.shape, 2))
        return applied(self._creep, still, rolled_m[..., None], np.abs(middle_m)[..., None])

    def _over_floor(self, turned_rad: Array, angle_rad: Array, place: FloorPlace) -> Array:
        """Return the turns (..., 2) of round wheels that travel as far over the floor as those of the robot.

        Args:
            turned_rad: Turns of the wheels.
            angle_rad: Angles in the middle of the turns.
            place: Where they begin.
        """
        if self._rolling:
            turned_rad = turned_rad * applied(self._rolling, np.ones_like(turned_rad), angle_rad, turned_rad)
        if self._travel:
            turned_rad = turned_rad * applied(self._travel, np.ones_like(turned_rad), place)
        return turned_rad

    def _arcs(self, turned_rad: Array, place: FloorPlace) -> tuple[Array, Array]:
        """Return distances forward [m] and turns [rad] of the body, (...), by the travels of round wheels (..., 2)."""
        travel = turned_rad @ self._body.to_twist.T
        forward_m, turn_rad = travel[..., 0], travel[..., 1]
        ones = np.ones_like(turn_rad)
        turn_rad = turn_rad * applied(self._ground, ones, forward_m / self._step_s, turn_rad / self._step_s)
        if self._turning:
            turn_rad = turn_rad * applied(self._turning, ones[..., None], place)[..., 0]
        return forward_m, turn_rad

    def _path(self, starts: Array, turned_rad: Array, place_m: Array) -> Array:
        """Return poses along the arcs of the wheels' travel, with the share of each turn that slip leaves.

        Args:
            starts: (N, 3), poses at the start.
            turned_rad: (T + 1, N, 2), turns of the wheels.
            place_m: (T + 1, N, 2), places where they begin.
        """
        time_s = np.arange(-1, len(turned_rad) - 1)[:, None, None] * self._step_s
        place = FloorPlace(place_m[..., :1], place_m[..., 1:], time_s)
        turned_rad = self._over_floor(turned_rad, np.cumsum(turned_rad, axis=0) - 0.5 * turned_rad, place)
        if self._slip:
            turned_rad = turned_rad * np.array([self._slip.travelled(step) for step in self._radius_m * turned_rad])
        forward_m, turn_rad = self._arcs(turned_rad, place)
        yaw_rad = starts[:, 2] + np.cumsum(turn_rad, axis=0)
        # The chord of an arc: sinc needs no division by the turn, which is 0 on a straight.
        chord_m = forward_m * np.sinc(turn_rad / (2.0 * pi))
        direction = yaw_rad - 0.5 * turn_rad
        x_m = starts[:, 0] + np.cumsum(chord_m * np.cos(direction), axis=0)
        y_m = starts[:, 1] + np.cumsum(chord_m * np.sin(direction), axis=0)
        if self._creep:
            crept_m = np.cumsum(self._crept(turned_rad), axis=0)
            x_m, y_m = x_m + crept_m[..., 0], y_m + crept_m[..., 1]
        return np.stack([x_m, y_m, yaw_rad], axis=-1)


class ReplayedWorld:
    """One trial of a twin's run as a world for sensors: rays of the arena from its poses, its counts, its time."""

    def __init__(self, run: TwinRun, trial: int, arena: Arena, physics_hz: int) -> None:
        self._run = run
        self._trial = trial
        self._rays = RayScene(arena)
        self._physics_hz = physics_hz
        self._steps = 0

    @property
    def steps(self) -> int:
        """Number of the sensors' steps; the steps of the run may be longer, and poses are interpolated between them."""
        return self._steps

    @property
    def time_s(self) -> float:
        return self._steps / self._physics_hz

    def advance(self, steps: int) -> None:
        """Advance by a number of the sensors' steps.

        Raises:
            ValueError: The run ends before that.
        """
        self._steps += steps
        end_s = float(self._run.t_s[-1])
        if self.time_s > end_s + 1e-9:
            raise ValueError(
                f"the time {self.time_s:g} s is after the end of the run at {end_s:g} s; drive it for longer"
            )

    def pose(self) -> PlanarPose:
        x, y, yaw = self._pose_at(self.time_s).tolist()
        return x, y, yaw

    def motion(self) -> BodyMotion:
        """Return the motion in the plane, from the poses half a step before and after this time."""
        half_s = 0.5 / self._physics_hz
        before, after = self._pose_at(self.time_s - half_s), self._pose_at(self.time_s + half_s)
        rates = (after - before) / (2.0 * half_s)
        x, y, yaw = self.pose()
        velocity, spin = np.array([rates[0], rates[1], 0.0]), np.array([0.0, 0.0, rates[2]])
        return BodyMotion(pose_X_WR(x, y, yaw)[:3, :3], np.array([x, y, 0.0]), velocity, spin)

    def _pose_at(self, time_s: float) -> Array:
        poses = self._run.pose[:, self._trial]
        return np.array([np.interp(time_s, self._run.t_s, column) for column in poses.T])

    def cast(self, origins: Array, ends: Array, time_s: float | None = None) -> RayHits:
        return self._rays.cast(origins, ends, self.time_s if time_s is None else time_s)

    def wheel_angles(self) -> tuple[float, float]:
        """Return the angles of the wheels since the start, right and left [rad]; none is lost."""
        t_s, speeds = self._run.t_s, self._run.wheel_speed_rad_s[:, self._trial]
        turned = np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(t_s)[:, None], axis=0)
        right, left = (np.interp(self.time_s, t_s, np.append(0.0, column)) for column in turned.T)
        return float(right), float(left)

    def encoder_counts(self) -> tuple[int, int]:
        row = int(np.searchsorted(self._run.t_s, self.time_s + 1e-9, side="right")) - 1
        right, left = self._run.counts[row, self._trial].tolist()
        return right, left
