"""Wheel speeds of a robot from the voltages of its two motors, for many worlds and trials side by side."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from .case import Array, World
from .motor_law import Motors

ROW_S = 0.05
PIECES = 10
"""Of a row, in each of which voltage and torque are constant: only a delay that ends inside one is blurred by it."""
SUPPLY_ROUNDS = 2
"""Of the fixed point that shares the sagging supply, from where it was a step before; each is three times closer."""
MISSED_EDGE_RAD_S = 0.3
SIDES = ("left", "right")


@dataclass(frozen=True)
class Wheels:
    """Both motors of V worlds; arrays are (V, 1, 1) or (V, 1, 2)."""

    motors: Motors
    source_ohm: Array
    decline_per_s: Array
    delay_s: Array

    @classmethod
    def from_worlds(cls, worlds: Sequence[World], supply_V: float) -> "Wheels":
        flat = Motors.from_worlds(worlds, supply_V)
        arrays = {f.name: getattr(flat, f.name)[..., None] for f in fields(flat) if f.name != "supply_V"}
        mismatch = _deep([w.value("torque_constant_mismatch", "mismatch", 0.0) for w in worlds])
        arrays["constant"] = arrays["constant"] * (1.0 + 0.5 * mismatch * np.array([1.0, -1.0]))
        source = arrays["source_ohm"]
        arrays["source_ohm"] = np.zeros_like(source)
        return cls(
            motors=Motors(**arrays, supply_V=supply_V),
            source_ohm=source,
            decline_per_s=_deep([w.value("battery_decline", "fraction_per_minute", 0.0) / 60.0 for w in worlds]),
            delay_s=_deep([w.value("input_delay", "delay_s", 0.0) for w in worlds]),
        )

    def voltage(self, command: Array, speed: Array, session_s: Array, before: Array | None = None) -> Array:
        """At the motors, (V, N, 2): the commanded share of a supply that declines and that both currents load."""
        duty = command / self.motors.supply_V
        supply = self.motors.supply_V * (1.0 - self.decline_per_s * session_s)
        voltage = duty * supply
        if not self.source_ohm.any():
            return voltage
        rounds = SUPPLY_ROUNDS if before is not None else 4 * SUPPLY_ROUNDS
        voltage = voltage if before is None else before
        for _ in range(rounds):
            load = np.sum(np.abs(duty * self.motors.current_A(voltage, speed)), axis=-1, keepdims=True)
            voltage = duty * (supply - self.source_ohm * load)
        return voltage

    def delayed(self, rows: Array, k: int, begin_s: float, step_s: float) -> Array:
        """Mean command over a step that begins so long after row k; `rows` are (N, T, 2)."""
        back = np.floor(self.delay_s / ROW_S).astype(int)
        older = np.clip((self.delay_s - back * ROW_S - begin_s) / step_s, 0.0, 1.0)
        found = np.zeros((len(back), rows.shape[0], 2))
        for v, n in enumerate(back.ravel().tolist()):
            new = rows[:, k - n] if k >= n else 0.0
            old = rows[:, k - n - 1] if k > n else 0.0
            found[v] = older[v] * old + (1.0 - older[v]) * new
        return found

    def row(self, speed: Array, rows: Array, k: int, begin_s: Array, pieces: Array) -> Iterator[tuple[Array, Array]]:
        """Speeds (V, N, 2) after each piece of row k, and means over it.

        Args:
            speed: At its beginning.
            rows: (N, T, 2), voltages that are commanded.
            k: Number of the row.
            begin_s: (N,), session times of the trials.
            pieces: (steps, N, 2) or (steps, 1, 1), disturbing torques in the pieces that make up a row.
        """
        step_s, late, sags = ROW_S / len(pieces), bool(self.delay_s.any()), bool(self.source_ohm.any())
        session = (begin_s + k * ROW_S)[:, None]
        command = rows[None, :, k]
        voltage = self.voltage(command, speed, session)
        for j, torque in enumerate(pieces):
            if late:
                command = self.delayed(rows, k, j * step_s, step_s)
                voltage = self.voltage(command, speed, session)
            after, mean = self.piece(speed, voltage, session, step_s, torque)
            if sags:  # once more, at the speed in the middle
                voltage = self.voltage(command, mean, session, voltage)
                after, mean = self.piece(speed, voltage, session, step_s, torque)
            speed = after
            yield after, mean

    def piece(
        self, speed: Array, voltage: Array, session_s: Array, step_s: float, torque: Array
    ) -> tuple[Array, Array]:
        """Speed after a time at constant voltage and disturbing torque, and its mean, by the solution of the equation.

        It is linear while a wheel turns one way; a wheel that comes to rest starts again from there, or stays.
        """
        motors = self.motors
        changed = 1.0 + motors.change * (session_s >= motors.change_s)
        dry, gain = motors.coulomb * changed, motors.constant / motors.resistance
        rests = speed == 0.0
        driving = voltage - motors.constant * speed
        coasts = np.abs(driving) <= motors.drop if self.drops else np.zeros(1, dtype=bool)
        pull = gain * (voltage - motors.drop * np.sign(driving)) * ~coasts + torque
        direction = np.sign(np.where(rests, pull, speed))
        damping = motors.viscous + gain * motors.constant * ~coasts
        final, decay = (pull - dry * direction) / damping, damping / motors.inertia
        left = np.exp(-step_s * decay)
        after = final + (speed - final) * left
        mean = final + (speed - final) * (1.0 - left) / (decay * step_s)
        stuck = rests & (np.abs(pull) <= dry)
        crossed = (direction * after < 0.0) & ~stuck
        after, mean = np.where(stuck, 0.0, after), np.where(stuck, 0.0, mean)
        if not crossed.any():
            return after, mean
        with np.errstate(divide="ignore", invalid="ignore"):
            until = np.log((speed - final) / -final) / decay
        way = final * until + speed / decay
        rest_s = step_s - until
        pull = gain * np.sign(voltage) * np.maximum(np.abs(voltage) - motors.drop, 0.0) + torque
        onward = np.sign(pull) * np.maximum(np.abs(pull) - dry, 0.0) / damping
        grown = 1.0 - np.exp(-rest_s * decay)
        way = way + onward * (rest_s - grown / decay)
        return np.where(crossed, onward * grown, after), np.where(crossed, way / step_s, mean)

    @cached_property
    def drops(self) -> bool:
        return bool(self.motors.drop.any())

    def pick(self, chosen: Sequence[int]) -> "Wheels":
        index = list(chosen)
        return replace(
            self,
            motors=self.motors.pick(index),
            source_ohm=self.source_ohm[index],
            decline_per_s=self.decline_per_s[index],
            delay_s=self.delay_s[index],
        )


def mean_speeds(wheels: Wheels, voltage: Array, begin_s: Array) -> Array:
    """Over each row, (V, N, T - 1, 2), from rest.

    Args:
        wheels: Of V worlds.
        voltage: (N, T, 2), held from each row to the next.
        begin_s: (N,), session time of each trial's start.
    """
    trials, rows = voltage.shape[:2]
    speed = np.zeros((len(wheels.delay_s), trials, 2))
    calm = np.zeros((PIECES, 1, 1))
    found = np.zeros((len(speed), trials, rows - 1, 2))
    for k in range(rows - 1):
        pieces = list(wheels.row(speed, voltage, k, begin_s, calm))
        found[:, :, k] = np.mean([mean for _, mean in pieces], axis=0)
        speed = pieces[-1][0]
    return found


def kept(world: World, speed: Array) -> Array:
    """Share of the ticks that are counted at these true speeds (..., 2)."""
    lost = np.array([world.value("encoder_missed_ticks", "fraction", 0.0, side) for side in SIDES])
    if not lost.any():
        return np.ones_like(speed)
    threshold = world.value("encoder_missed_ticks", "threshold_rad_s", 0.0)
    return 1.0 - lost / (1.0 + np.exp(-(np.abs(speed) - threshold) / MISSED_EDGE_RAD_S))


def radii(world: World) -> Array:
    """Left and right, (2,)."""
    asymmetry = world.value("wheel_radius_asymmetry", "asymmetry", 0.0)
    radius = world.own["wheel_radius_m"] * world.value("wheel_radius_scale", "scale", 1.0)
    return radius * (1.0 + 0.5 * asymmetry * np.array([1.0, -1.0]))


def separation(world: World) -> float:
    return world.own["wheel_separation_m"] * world.value("wheelbase_scale", "scale", 1.0)


def turned(world: World, travel: Array, dt_s: float) -> Array:
    """Yaw of (..., 2) travels of the wheels in a time; wheels slip sideways in fast curves."""
    yaw = (travel[..., 1] - travel[..., 0]) / separation(world)
    ahead = 0.5 * (travel[..., 0] + travel[..., 1])
    slip = world.value("turn_slip", "coefficient_s2_m", 0.0)
    return yaw / (1.0 + slip * np.abs(ahead * yaw) / dt_s**2)


def ground(world: World, travel: Array, angle: Array, place: Array) -> Array:
    """Travels (..., 2) as wheels that are not round and the floor leave them, at wheel angles and places (..., 2)."""
    sizes = np.array([world.value("wheel_eccentricity", "amplitude", 0.0, side) for side in SIDES])
    if sizes.any():
        travel = travel * (1.0 + sizes * np.cos(angle + world.value("wheel_eccentricity", "phase_rad", 0.0)))
    slip = world.beyond("slippery_patch", "share")
    if slip:
        centre = np.array([world.beyond("slippery_patch", name) for name in ("x_m", "y_m")])
        inside = np.linalg.norm(place - centre, axis=-1) < world.beyond("slippery_patch", "radius_m")
        travel = travel * np.where(inside, 1.0 - slip, 1.0)[..., None]
    slip = world.beyond("edge_on_the_floor", "share")
    if slip:
        centre = np.array([world.beyond("edge_on_the_floor", name) for name in ("x_m", "y_m")])
        inside = np.linalg.norm(place - centre, axis=-1) < world.beyond("edge_on_the_floor", "radius_m")
        shorter = np.where(inside, 1.0 - slip, 1.0)
        travel = travel * np.stack([shorter, np.ones_like(shorter)], axis=-1)
    return travel


def slope(world: World, travel: Array) -> Array:
    """Displacement downhill (..., 2) in the room for (..., 2) travels of the wheels."""
    size, way = (world.value("floor_slope", name, 0.0) for name in ("gradient", "direction_rad"))
    moved = np.mean(np.abs(travel), axis=-1)
    return size * np.stack([moved * np.cos(way), moved * np.sin(way)], axis=-1)


def _deep(values: Sequence[float]) -> Array:
    return np.array(values, dtype=np.float64)[:, None, None]
