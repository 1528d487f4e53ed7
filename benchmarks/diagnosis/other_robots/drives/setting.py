"""The robot of a case, its trials, and runs with any effects."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S
from benchmarks.diagnosis.other_robots.draws import draw_deviations
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.predicted.stages import Staged
from benchmarks.diagnosis.other_robots.drives.robot import NOMINAL, draw_robot
from benchmarks.diagnosis.other_robots.drives.simulated.disturbances import disturb
from benchmarks.diagnosis.other_robots.drives.simulated.plans import draw_run
from benchmarks.diagnosis.other_robots.drives.simulated.simulation import Run
from benchmarks.diagnosis.other_robots.drives.table import POSES, RANGES, STAGES, WHEELS, named_table, outside_table
from benchmarks.diagnosis.other_robots.effects import Table
from benchmarks.diagnosis.other_robots.hidden import Hidden

WALL_MARGIN_M = 0.01


@dataclass
class Driven:
    """A log with disturbances, what these are, and whether the robot stayed in the room."""

    log: Log
    disturbances: dict[str, Any]
    inside: bool


class DriveSetting:
    """A robot with its trials and deviations, and a run of it without effects."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.bot = draw_robot(rng)
        self.draws = draw_run(rng, self.bot)
        trials = len(self.draws.rows)
        self.fit = list(range(trials - (2 if trials == 4 and rng.random() < 0.4 else 1)))
        session = float(sum(self.draws.rows) * WHEEL_DT_S + self.draws.gaps[:-1].sum())
        self.named, self.outside = named_table(self.bot, session), outside_table(self.bot, session)
        self.table: Table = {**self.named, **self.outside}
        self.logged = bool(rng.random() < 0.75)
        self.shown = (WHEELS if self.logged else "") + POSES + RANGES
        self.deviations = draw_deviations(rng, NOMINAL)
        self.disturbance_seed = int(rng.integers(1 << 30))
        self.plain = self.drive(Hidden())
        self.wheel_sd, self.rho = self._wheel_noise()
        self.fit_sd = self.wheel_sd * float(np.sqrt((1 + self.rho) / (1 - self.rho)))
        """Noise of the wheel speeds in the likelihood ratios: correlated noise counts for less."""

    def drive(self, hidden: Hidden) -> Driven:
        """Return a run with some effects; all runs have the same random numbers."""
        run = Run(self.bot, self.draws, self.table, hidden.keys, hidden.theta(self.deviations))
        log, true_pose = run.drive()
        far_sides = np.array(self.bot.room) - WALL_MARGIN_M
        inside = bool(np.all((true_pose[:, :2] > WALL_MARGIN_M) & (true_pose[:, :2] < far_sides)))
        disturbances = disturb(np.random.default_rng(self.disturbance_seed), self.bot, log)
        return Driven(log, disturbances, inside)

    def _wheel_noise(self) -> tuple[float, float]:
        """Return standard deviation and correlation of the wheel speeds about those without outside torque."""
        trials = list(range(len(self.draws.rows)))
        staged = Staged(self.bot, self.plain.log, self.table, WHEELS, trials, wheel_sd=1.0)
        mask = staged.measured.mask
        residuals = np.where(mask, staged.target - staged.predict([], self.deviations[None])[0], 0)
        sd = float(np.sqrt(np.mean(residuals[mask] ** 2)))
        rho = np.mean(residuals[1:] * residuals[:-1]) / np.mean(residuals**2)
        return sd, float(np.clip(rho, 0, 0.9))

    def staged(self, log: Log, stages: str) -> Staged:
        """Return the stages of the fit trials of a log."""
        return Staged(self.bot, log, self.table, stages, self.fit, wheel_sd=self.fit_sd)

    def visible(self, name: str) -> bool:
        """Return whether an effect shows in what is logged."""
        return bool(set(STAGES[name]) & set(self.shown))

    def stages_of(self, names: list[str], more: str = "") -> str:
        """Return the logged stages in which some effects show, and some more."""
        return "".join(stage for stage in self.shown if stage in more or any(stage in STAGES[name] for name in names))
