"""A robot that drives about a room under its own wheel-speed controller."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from .case import Array, World
from .drive_wheels import PIECES, ROW_S, Wheels, ground, kept, radii, slope, turned

STEP_S = ROW_S / PIECES
MARGIN_M = 0.45
MAX_YAW_RATE = 2.2
DISTURBANCE_S = 0.03
PROPORTIONAL_V_S = 0.2
INTEGRAL_V = 0.6


@dataclass
class Tour:
    """Where one trial is going: to places by arcs or by a turn on the spot and a straight run, with spins and stops."""

    rng: np.random.Generator
    room: tuple[float, float]
    mode: str = "stop"
    until_s: float = -1.0
    speed: float = 0.0
    goal: tuple[float, float] = (0.0, 0.0)
    command: tuple[float, float] = (0.0, 0.0)

    def wanted(self, time_s: float, pose: Array) -> tuple[float, float]:
        """Forward speed [m/s] and yaw rate [rad/s]."""
        x, y, theta = pose.tolist()
        away = float(np.hypot(self.goal[0] - x, self.goal[1] - y))
        if time_s >= self.until_s or (self.mode in {"arc", "turn"} and away < 0.06):
            self._next(time_s)
        if self.mode in {"stop", "spin"}:
            return self.command
        error = np.arctan2(self.goal[1] - y, self.goal[0] - x) - theta
        error = float((error + np.pi) % (2.0 * np.pi) - np.pi)
        yaw_rate = float(np.clip(2.5 * error, -MAX_YAW_RATE, MAX_YAW_RATE))
        slow = 0.0 if self.mode == "turn" else 0.3
        return (self.speed if abs(error) < 0.4 else slow * self.speed), yaw_rate

    def _next(self, time_s: float) -> None:
        self.mode = str(self.rng.choice(["arc", "turn", "spin", "stop"], p=[0.45, 0.3, 0.13, 0.12]))
        self.speed = float(self.rng.uniform(0.1, 0.35))
        last = {"stop": (0.3, 0.9), "spin": (1.0, 3.0)}.get(self.mode, (12.0, 12.0))
        self.until_s = time_s + float(self.rng.uniform(*last))
        sides = [float(self.rng.uniform(MARGIN_M, side - MARGIN_M)) for side in self.room]
        self.goal = (sides[0], sides[1])
        yaw_rate = float(self.rng.choice([-1.0, 1.0]) * self.rng.uniform(0.8, MAX_YAW_RATE))
        self.command = (0.0, yaw_rate if self.mode == "spin" else 0.0)


@dataclass(frozen=True)
class Driven:
    """N trials of T rows.

    Attributes:
        command: (N, T, 2), wanted forward speed and yaw rate.
        voltage: (N, T, 2), left and right.
        ticks: (N, T, 2).
        pose: (N, M, 3), true, every five milliseconds.
        time_s: (M,) of those.
    """

    command: Array
    voltage: Array
    ticks: Array
    pose: Array
    time_s: Array


def drive(nominal: Mapping, world: World, begin_s: Array, rows: int, rng: np.random.Generator) -> Driven:
    """Trials that begin at rest near the middle of the room at these session times."""
    trials = len(begin_s)
    room = (nominal["world"]["room_x_m"], nominal["world"]["room_y_m"])
    tours = [Tour(np.random.default_rng(rng.integers(2**31)), room) for _ in range(trials)]
    robot = _Robot(nominal, world, trials, rng)
    command, voltage = np.full((2, trials, rows, 2), np.nan)
    ticks = np.zeros((trials, rows, 2))
    path = np.zeros((trials, (rows - 1) * PIECES + 1, 3))
    path[:, 0] = robot.pose
    torque = robot.disturbances((rows - 1) * PIECES)
    for k in range(rows):
        ticks[:, k] = robot.ticks
        if k == rows - 1:
            break
        command[:, k] = np.round(
            [tour.wanted(k * ROW_S, pose) for tour, pose in zip(tours, robot.pose, strict=True)], 3
        )
        robot.control(command[:, k], ticks[:, k] - ticks[:, max(k - 1, 0)])
        voltage[:, k] = robot.held
        for j, turn in enumerate(robot.wheel_turns(voltage, k, begin_s, torque[k * PIECES : (k + 1) * PIECES])):
            robot.move(turn)
            path[:, k * PIECES + j + 1] = robot.pose
    return Driven(command, voltage, ticks, path, STEP_S * np.arange(path.shape[1]))


class _Robot:
    """State of all trials."""

    def __init__(self, nominal: Mapping, world: World, trials: int, rng: np.random.Generator) -> None:
        self.world, self.rng = world, rng
        self.wheels = Wheels.from_worlds([world], nominal["motor"]["supply_voltage_V"])
        self.value = {name: leaf["value"] for name, leaf in nominal["motor"].items() if isinstance(leaf, dict)}
        self.value |= {name: leaf["value"] for name, leaf in nominal["robot"].items() if isinstance(leaf, dict)}
        self.supply = nominal["motor"]["supply_voltage_V"]
        self.per_turn = nominal["robot"]["encoder_ticks_per_revolution"]
        self.slip = nominal["noise"]["travel_m_per_sqrt_m"]
        self.torque_sd = self._disturbance(nominal["noise"]["wheel_speed_rad_s"])
        room = [nominal["world"][name] for name in ("room_x_m", "room_y_m")]
        middle = np.tile([0.5 * room[0], 0.5 * room[1], 0.0], (trials, 1))
        self.pose = middle + np.stack([np.zeros(trials)] * 2 + [rng.uniform(-np.pi, np.pi, trials)], axis=1)
        self.speed = np.zeros((1, trials, 2))
        self.angle = np.zeros((trials, 2))
        self.counted = np.zeros((trials, 2))
        self.sum = np.zeros((trials, 2))
        self.held = np.zeros((trials, 2))

    def _disturbance(self, speed_sd: float) -> float:
        """Of a torque with a short memory that, with the rounding to ticks, makes this noise of the wheel speeds."""
        tick = 2.0 * np.pi / self.per_turn / ROW_S
        left = np.sqrt(max(speed_sd**2 - tick**2 / 6.0, 0.0))
        value = self.value
        damping = value["torque_constant_N_m_A"] ** 2 / value["winding_resistance_ohm"]
        constant_s = value["rotor_inertia_kg_m2"] / damping
        return left * damping * np.sqrt((constant_s + DISTURBANCE_S) / DISTURBANCE_S)

    @property
    def ticks(self) -> Array:
        scale = self.world.value("encoder_ticks_scale", "scale", 1.0)
        return np.rint(self.counted * self.per_turn * scale / (2.0 * np.pi))

    def control(self, command: Array, new_ticks: Array) -> None:
        """Feed-forward of the nominal motor, with a proportional and an integral part on the measured speed."""
        value = self.value
        half = 0.5 * value["wheel_separation_m"] * command[:, 1]
        wanted = np.stack([command[:, 0] - half, command[:, 0] + half], axis=1) / value["wheel_radius_m"]
        measured = new_ticks * 2.0 * np.pi / self.per_turn / ROW_S
        friction = value["viscous_friction_N_m_s_rad"] * wanted + value["coulomb_friction_N_m"] * np.sign(wanted)
        ahead = value["torque_constant_N_m_A"] * wanted
        ahead = ahead + value["winding_resistance_ohm"] / value["torque_constant_N_m_A"] * friction
        self.sum = np.where(wanted == 0.0, 0.0, np.clip(self.sum + ROW_S * (wanted - measured), -3.0, 3.0))
        voltage = ahead + PROPORTIONAL_V_S * (wanted - measured) + INTEGRAL_V * self.sum
        self.held = np.round(np.clip(np.where(wanted == 0.0, 0.0, voltage), -self.supply, self.supply), 3)

    def disturbances(self, steps: int) -> Array:
        """Torques on the wheels with a short memory, (steps, N, 2)."""
        keep = np.exp(-STEP_S / DISTURBANCE_S)
        fresh = self.rng.standard_normal((steps, *self.angle.shape))
        return np.asarray(lfilter([self.torque_sd * np.sqrt(1.0 - keep**2)], [1.0, -keep], fresh, axis=0))

    def wheel_turns(self, voltage: Array, k: int, begin_s: Array, torque: Array) -> Iterator[Array]:
        """Angles (N, 2) by which the wheels turn in each piece of row k."""
        for after, mean in self.wheels.row(self.speed, voltage, k, begin_s, torque):
            self.speed = after
            yield STEP_S * mean[0]

    def move(self, turn: Array) -> None:
        travel = ground(self.world, radii(self.world) * turn, self.angle + 0.5 * turn, self.pose[:, :2])
        travel = travel + self.slip * np.sqrt(np.abs(travel)) * self.rng.standard_normal(travel.shape)
        self.angle = self.angle + turn
        self.counted = self.counted + turn * kept(self.world, turn / STEP_S)
        yaw = turned(self.world, travel, STEP_S)
        ahead, heading = 0.5 * travel.sum(axis=1), self.pose[:, 2] + 0.5 * yaw
        moved = np.stack([ahead * np.cos(heading), ahead * np.sin(heading)], axis=1) + slope(self.world, travel)
        self.pose = self.pose + np.concatenate([moved, yaw[:, None]], axis=1)
