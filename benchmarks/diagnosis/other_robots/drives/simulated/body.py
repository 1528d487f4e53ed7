"""How a robot moves when its wheels turn."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.robot import Robot
from benchmarks.diagnosis.other_robots.drives.table import SIDES
from benchmarks.diagnosis.other_robots.drives.values import Values
from benchmarks.diagnosis.other_robots.drives.wheels import missed_share


class Body:
    """Pose, wheel angles and encoders of one trial."""

    def __init__(self, bot: Robot, values: Values, theta: Array, start: Array) -> None:
        self.bot, self.values = bot, values
        self.radius = bot.radius * (1 + theta[5] * bot.loose["r"]) * values.one("wheel_radius_scale", 1.0)
        self.track = bot.track * (1 + theta[6] * bot.loose["b"]) * values.one("wheelbase_scale", 1.0)
        self.ticks_per_turn = bot.encoder.ticks * values.one("encoder_ticks_scale", 1.0)
        self.travel_noise = bot.travel * bot.factors["travel"]
        self.min_turn = 0.02 * (1.4 * bot.speed / bot.track) * DT_S
        self.x, self.y, self.heading = start
        self.turned, self.count, self.speeds, self.last_turn = [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], 0.0

    def in_patch(self, x: float, y: float, radius: float) -> bool:
        """Return whether the robot is in a circle whose centre is given in shares of the room."""
        return bool(np.hypot(self.x - x * self.bot.room[0], self.y - y * self.bot.room[1]) < radius)

    def outside_torque(self) -> tuple[float, float]:
        """Return extra friction and outside torque on each wheel at this place."""
        patch, cable = self.values.all("carpet_patch"), self.values.all("cable_pulls")
        drag = patch[0] if patch and self.in_patch(*patch[1:]) else 0.0
        if not cable:
            return drag, 0.0
        room = self.bot.room
        pull = np.arctan2(cable[2] * room[1] - self.y, cable[1] * room[0] - self.x) - self.heading
        return drag, cable[0] * np.cos(pull)

    def _roll(self, c: int, moved: float, session: float, noise: float) -> float:
        """Return the distance that a wheel rolls."""
        values, angle = self.values, self.turned[c]
        asymmetry, warming = values.one("wheel_radius_asymmetry"), values.one("tyre_warms")
        size = self.radius * (1 + (0.5 - c) * asymmetry) * (1 + warming * session)
        eccentricity, rolled = values.all("wheel_eccentricity", SIDES[c]), moved
        if eccentricity:
            amplitude, phase = eccentricity
            rolled += amplitude * (np.sin(angle + moved + phase) - np.sin(angle + phase))
        slip = values.one("slip_when_accelerating")
        if slip:
            gain = (abs(moved / DT_S) - abs(self.speeds[c])) / DT_S
            rolled *= 1 - min(0.8, slip * max(0.0, gain))
        distance = size * rolled
        return distance + self.travel_noise * np.sqrt(abs(distance)) * noise

    def _count(self, c: int, moved: float) -> None:
        """Advance an encoder."""
        missed = self.values.all("encoder_missed_ticks", SIDES[c])
        share = float(missed_share(moved / DT_S, missed)) if missed else 0.0
        self.count[c] += moved * (1 - share) * self.ticks_per_turn / (2 * np.pi)

    def advance(self, angles: Array, session: float, noise: Array) -> None:
        """Move to the wheel angles at the end of a row."""
        distances = []
        for c in range(2):
            moved = float(angles[c] - self.turned[c])
            distances.append(self._roll(c, moved, session, noise[c]))
            self._count(c, moved)
            self.turned[c] += moved
            self.speeds[c] = moved / DT_S
        forward, turn = 0.5 * (distances[0] + distances[1]), (distances[1] - distances[0]) / self.track
        turn /= 1 + self.values.one("turn_slip") * abs(forward * turn) / DT_S**2
        self._move(forward, self._kicked(turn))

    def _kicked(self, turn: float) -> float:
        """Return the turn with the kick of a caster, which comes when the turn changes its direction."""
        kick = self.values.one("caster_kick")
        if kick and np.sign(turn) * np.sign(self.last_turn) < 0 and abs(turn) > self.min_turn:
            turn += kick * np.sign(turn)
        if abs(turn) > self.min_turn:
            self.last_turn = turn
        return turn

    def _move(self, forward: float, turn: float) -> None:
        """Move forward and sideways."""
        middle = self.heading + 0.5 * turn
        gradient, direction = self.values.all("floor_slope") or [0.0, 0.0]
        creep = abs(forward) * gradient
        self.x += forward * np.cos(middle) + creep * np.cos(direction)
        self.y += forward * np.sin(middle) + creep * np.sin(direction)
        patch = self.values.all("sideways_on_patch")
        if patch and self.in_patch(patch[2], patch[3], 0.25 * min(self.bot.room)):
            self.x += abs(forward) * patch[0] * np.cos(patch[1])
            self.y += abs(forward) * patch[0] * np.sin(patch[1])
        self.heading += turn
