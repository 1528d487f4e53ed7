"""A run of a robot, simulated row by row."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S as DT_S
from benchmarks.diagnosis.other_robots.compiled import advance_wheels
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import Robot
from benchmarks.diagnosis.other_robots.drives.simulated.body import Body
from benchmarks.diagnosis.other_robots.drives.simulated.driver import Driver
from benchmarks.diagnosis.other_robots.drives.simulated.plans import Draws
from benchmarks.diagnosis.other_robots.drives.simulated.readings import add_readings
from benchmarks.diagnosis.other_robots.drives.values import Values
from benchmarks.diagnosis.other_robots.drives.wheels import wheel_parameters
from benchmarks.diagnosis.other_robots.effects import Key, Table


class Run:
    """A robot with some effects that drives all trials."""

    def __init__(self, bot: Robot, draws: Draws, table: Table, keys: list[Key], theta: Array) -> None:
        n, m = sum(draws.rows), bot.motor
        self.bot, self.draws, self.theta = bot, draws, theta
        self.values = Values(table, keys, theta)
        self.parameters = np.ascontiguousarray(wheel_parameters(bot, table, keys, theta[None]))
        self.push = bot.wheel_sd * (m.K**2 / m.R + m.B) * 1.3 * draws.push
        self.drag, self.angles = np.zeros((2, n)), np.zeros((1, 2, n))
        self.pose = np.zeros((n, 3))
        last = np.cumsum(draws.rows)
        empty = {name: np.zeros((2, n)) for name in ("u", "ticks")}
        ends = [int(row) for row in last]
        self.log = Log(
            trial=np.zeros(n, int),
            session=np.zeros(n),
            t=np.zeros(n),
            commands=np.full((2, n), np.nan),
            pose=self.pose,
            ranges=np.zeros((3, n)),
            starts=[0, *ends[:-1]],
            ends=ends,
            **empty,
        )

    def drive(self) -> tuple[Log, Array]:
        """Return what is logged, and the true poses."""
        log, chance, clock = self.log, np.random.default_rng(self.draws.seed), 0.0
        for q, rows in enumerate(self.draws.rows):
            self._trial(q, clock, chance)
            clock += rows * DT_S + self.draws.gaps[q]
        log.session, log.ticks = np.round(log.session, 2), np.floor(log.ticks + 1e-9)
        add_readings(self.bot, self.draws, self.values, float(self.theta[7]), log)
        return log, self.pose

    def _trial(self, q: int, clock: float, chance: np.random.Generator) -> None:
        """Drive one trial."""
        log, start = self.log, self.log.starts[q]
        body = Body(self.bot, self.values, self.theta, self.draws.first[q])
        driver = Driver(self.bot, self.draws.plans[q], chance, body.x, body.y)
        state = np.zeros((1, 4))
        for k in range(self.draws.rows[q]):
            row = start + k
            log.trial[row], log.t[row], log.session[row] = q + 1, k * DT_S, clock + k * DT_S
            self.pose[row] = body.x, body.y, body.heading
            log.ticks[:, row] = body.count
            if row == log.ends[q] - 1:
                return
            log.commands[:, row] = driver.command(body.x, body.y, body.heading)
            log.u[:, row] = driver.voltages(body.speeds)
            drag, push = body.outside_torque()
            self.drag[:, row] += drag
            self.push[:, row] += push
            inputs = (log.u, log.session, self.push, self.drag)
            advance_wheels(self.parameters, inputs, state, self.angles, (row, row + 1, start))
            body.advance(self.angles[0, :, row], log.session[row], self.draws.slip[:, row])
