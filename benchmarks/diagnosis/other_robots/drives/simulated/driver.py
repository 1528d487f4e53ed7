"""The controller that drives a trial along its plan."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.drives.robot import Robot
from benchmarks.diagnosis.other_robots.drives.simulated.plans import Plan


def _turn_to(x: float, y: float, heading: float, goal: tuple[float, float]) -> float:
    """Return the angle between the heading and the direction of a goal."""
    away = float(np.arctan2(goal[1] - y, goal[0] - x) - heading)
    return (away + np.pi) % (2 * np.pi) - np.pi


class Driver:
    """Commands and voltages of one trial."""

    def __init__(self, bot: Robot, plan: Plan, chance: np.random.Generator, x: float, y: float) -> None:
        self.bot, self.plan, self.chance = bot, plan, chance
        self.target, self.hold = 0, 0
        if plan.kind in {"laps", "eight", "rectangle"}:
            self.target = int(np.argmin(np.hypot(plan.points[:, 0] - x, plan.points[:, 1] - y)))
        self.v = self.w = 0.0
        self.arc = (0.0, 0.0)
        self.integral = [0.0, 0.0]
        self.fastest_turn = 1.4 * bot.speed / bot.track
        self.cruise = bot.speed * chance.uniform(0.45, 0.95)

    def command(self, x: float, y: float, heading: float) -> tuple[float, float]:
        """Return forward speed and yaw rate."""
        if self.plan.kind == "arcs":
            v, w = self._along_arcs(x, y, heading)
        elif self.hold > 0:
            self.hold -= 1
            v = w = 0.0
        else:
            v, w = self._to_points(x, y, heading)
        if not self.plan.ramp:
            self.v, self.w = v, w
        else:
            most = self.plan.ramp * self.bot.speed * DT_S
            self.v += float(np.clip(v - self.v, -most, most))
            self.w += float(np.clip(w - self.w, -8 * most / self.bot.track, 8 * most / self.bot.track))
        return self.v, self.w

    def _along_arcs(self, x: float, y: float, heading: float) -> tuple[float, float]:
        """Return the command on random arcs, which turn back at the walls."""
        room, cruise = self.bot.room, self.cruise
        if min(x, y, room[0] - x, room[1] - y) < 0.6 * self.bot.track + 0.04 + 0.2 * cruise:
            away = _turn_to(x, y, heading, (room[0] / 2, room[1] / 2))
            self.arc = (0.0, np.sign(away) * 0.8 * self.fastest_turn) if abs(away) > 0.5 else (0.6 * cruise, 0.0)
            self.hold = 3
        elif self.hold <= 0:
            self.arc = (cruise * self.chance.uniform(0.2, 1.1), self.chance.normal() * 0.35 * self.fastest_turn)
            self.hold = int(self.chance.integers(8, 60))
        self.hold -= 1
        return self.arc

    def _to_points(self, x: float, y: float, heading: float) -> tuple[float, float]:
        """Return the command towards the next point of the plan."""
        goal, cruise = self.plan.points[self.target % len(self.plan.points)], self.cruise
        away = _turn_to(x, y, heading, goal)
        w = float(np.clip(2.5 * away, -self.fastest_turn, self.fastest_turn))
        if self.plan.kind in {"rectangle", "stop_and_go"}:
            v = 0.0 if abs(away) > 0.35 else cruise
        else:
            v = cruise * max(0.15, np.cos(away)) if abs(away) < 1.3 else 0.0
        if float(np.hypot(goal[0] - x, goal[1] - y)) < max(0.05, 0.25 * self.bot.track, 0.12 * cruise / 0.5):
            self.target += 1
            if self.plan.pauses:
                self.hold = int(self.chance.integers(6, 40))
                self.cruise = self.bot.speed * self.chance.uniform(0.25, 1.0)
        return v, w

    def voltages(self, speeds: list[float]) -> list[float]:
        """Return the voltages of both wheels: feed-forward of the nominal motor and PI control."""
        m, volts = self.bot.motor, []
        for c, sign in enumerate((-1, 1)):
            set_speed = (self.v + sign * 0.5 * self.bot.track * self.w) / self.bot.radius
            error = set_speed - speeds[c]
            moves = abs(set_speed) > 1e-6
            self.integral[c] = float(np.clip(self.integral[c] + error * DT_S, -3, 3)) if moves else 0.0
            feed = m.K * set_speed + m.R / m.K * (m.B * set_speed + m.Tc * np.sign(set_speed))
            u = feed + m.K * (0.4 * error + 1.2 * self.integral[c])
            volts.append(round(float(np.clip(u, -m.supply, m.supply)), 3))
        return volts
