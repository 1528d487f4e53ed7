"""The robot without an engine: the same chain from voltages to poses and counts, for many trials of one robot at once.

Motors are stepped exactly, wheels roll without slip, each step's path is an arc. What PyBullet has and this has not:
contacts with walls, wheels that slide, tilting, and the shift of load between wheels and caster.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from physics.arena import Arena
from physics.body_inertia import BodyOnWheels
from physics.driveline import Driveline
from physics.motor_arrays import HeldDrive
from physics.rays import Hits, RayScene
from physics.robot_model import RobotModel, through
from physics.terms.base import Slot
from physics.wheel_loop import voltage_limit_V

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwinRun:
    """N trials at T + 1 times; wheels are right and left."""

    t_s: Array
    """(T + 1,), [s]."""
    pose: Array
    """(T + 1, N, 3), x [m], y [m], yaw [rad] in W, yaw unwrapped."""
    wheel_speed_rad_s: Array
    """(T + 1, N, 2)."""
    current_A: Array
    """(T + 1, N, 2), at the voltage of the step before."""
    counts: NDArray[np.int64]
    """(T + 1, N, 2), of the encoders since the start."""


class KinematicTwin:
    """Open-loop drives of one robot.

    Raises:
        InputError: The robot has play in its gears.
    """

    def __init__(self, model: RobotModel, step_s: float = 0.005) -> None:
        model.require_rigid_gears("the twin")
        self._step_s = step_s
        self._limit_V = voltage_limit_V(model.config.power)
        self._driveline = Driveline.of_robot(model)
        self._body = BodyOnWheels.from_model(model)
        inertia = self._body.wheel_inertia_kg_m2
        self._inertia = np.diag(inertia) + self._driveline.inertia_kg_m2
        self._coupling = inertia - np.diag(np.diag(inertia))
        self._delay_steps = round(model.input_delay_s / step_s)
        self._counting = model.effects(Slot.COUNTING)
        self._ground = model.effects(Slot.GROUND)
        self._counts_per_rad = model.counts_per_revolution / (2.0 * pi)

    def drive(self, voltages_V: Array, starts: Array) -> TwinRun:
        """Open loop from rest.

        Args:
            voltages_V: (T, N, 2), right and left, each held for one step.
            starts: (N, 3), x [m], y [m], yaw [rad].
        """
        steps, lanes, _ = voltages_V.shape
        commands = np.clip(voltages_V, -self._limit_V, self._limit_V)
        late = np.zeros((min(self._delay_steps, steps), lanes, 2))
        commands = np.concatenate([late, commands[: steps - len(late)]])
        speed, voltage, turned = (np.zeros((steps + 1, lanes, 2)) for _ in range(3))
        held = acceleration = np.zeros((lanes, 2))
        for k in range(steps):
            held, voltage[k + 1] = self._driveline.voltage_V(held, commands[k], k * self._step_s, self._step_s)
            speed[k + 1], turned[k + 1] = self._wheels(voltage[k + 1], speed[k], acceleration, k * self._step_s)
            acceleration = (speed[k + 1] - speed[k]) / self._step_s
        counted = np.cumsum(through(self._counting, turned, self._step_s), axis=0)
        return TwinRun(
            t_s=np.arange(steps + 1) * self._step_s,
            pose=self._path(starts, turned),
            wheel_speed_rad_s=speed,
            current_A=self._driveline.current_A(voltage, speed),
            counts=np.floor(counted * self._counts_per_rad + 0.5).astype(np.int64),
        )

    def _wheels(self, voltage_V: Array, speed: Array, acceleration: Array, time_s: float) -> tuple[Array, Array]:
        """Speeds after a step, and angles turned. What one wheel asks of the other is that of the step before."""
        driveline = self._driveline
        torque = driveline.stall_torque_N_m(voltage_V) + driveline.extra_torque_N_m(voltage_V, speed)
        friction = driveline.friction_N_m(torque, speed, time_s)
        torque = torque + self._body.load_N_m(speed) - acceleration @ self._coupling
        return HeldDrive(torque, driveline.damping_N_m_s_rad, friction, self._inertia).step(speed, self._step_s)

    def _path(self, starts: Array, turned_rad: Array) -> Array:
        """Poses along the arcs of the wheels' travel, with the share of each turn that slip leaves."""
        travel = turned_rad @ self._body.to_twist.T
        forward_m, turn_rad = travel[..., 0], travel[..., 1]
        ones = np.ones_like(turn_rad)
        turn_rad = turn_rad * through(self._ground, ones, forward_m / self._step_s, turn_rad / self._step_s)
        yaw_rad = starts[:, 2] + np.cumsum(turn_rad, axis=0)
        chord_m = forward_m * np.sinc(turn_rad / (2.0 * pi))
        direction = yaw_rad - 0.5 * turn_rad
        x_m = starts[:, 0] + np.cumsum(chord_m * np.cos(direction), axis=0)
        y_m = starts[:, 1] + np.cumsum(chord_m * np.sin(direction), axis=0)
        return np.stack([x_m, y_m, yaw_rad], axis=-1)


class ReplayedWorld:
    """One trial of a twin's run, for sensors to look at: the arena's rays from its poses, its counts, its time."""

    def __init__(self, run: TwinRun, trial: int, arena: Arena, physics_hz: int) -> None:
        self._run = run
        self._trial = trial
        self._rays = RayScene(arena)
        self._physics_hz = physics_hz
        self._steps = 0

    @property
    def steps(self) -> int:
        """As the sensors count them; the run's own steps may be longer, between them the pose is interpolated."""
        return self._steps

    @property
    def time_s(self) -> float:
        return self._steps / self._physics_hz

    def advance(self, steps: int) -> None:
        """Go on by so many steps of the sensors.

        Raises:
            ValueError: Beyond the end of the run, where nothing is known.
        """
        self._steps += steps
        end_s = float(self._run.t_s[-1])
        if self.time_s > end_s + 1e-9:
            raise ValueError(f"asked for {self.time_s:g} s of a run that ends at {end_s:g} s; drive it for longer")

    def pose(self) -> tuple[float, float, float]:
        poses = self._run.pose[:, self._trial]
        x, y, yaw = (float(np.interp(self.time_s, self._run.t_s, column)) for column in poses.T)
        return x, y, yaw

    def cast(self, origins: Array, ends: Array) -> Hits:
        return self._rays.cast(origins, ends, self.time_s)

    def encoder_counts(self) -> tuple[int, int]:
        row = int(np.searchsorted(self._run.t_s, self.time_s + 1e-9, side="right")) - 1
        right, left = self._run.counts[row, self._trial].tolist()
        return right, left
