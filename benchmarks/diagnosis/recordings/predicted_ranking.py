"""Whether a calibrated dataset ranks localisation methods as recordings of the real robot do.

    python benchmarks/diagnosis/recordings/predicted_ranking.py FOLDER [--runs 20]

The robot of OptiOdom logs (FOLDER) is diagnosed on every second session of each kind of path. Fourteen methods of
localisation, variants of odometry and of a Kalman filter with a fix of the pose every ten seconds, then run on

    recordings    runs of the other sessions
    calibrated    as many drives in PyBullet of robots drawn as `--like` does, with the wheel speeds of fitted runs
    fleet         the same with the shipped robot `fleet`, whose wheels are those of the drawing, without random slip

The error of a method in a run is the root mean square error of the place over the run, and its rank follows from the
median over the runs. Spearman's correlation of the ranks is that with the recordings; its 95 % interval is from 1000
bootstrap samples of the runs of both.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from calibrated_filter import datasets, halves_of
from numpy.typing import NDArray
from scipy.stats import spearmanr

from configs.draw import draw_robot, draw_run
from configs.loader import load_scenario, load_section
from configs.posterior.schema import FILE
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from diagnosis.diagnose import diagnose
from diagnosis.importers.optiodom import ENCODER_TICKS_PER_REVOLUTION, IMPORTER, TRACK_M, WHEEL_DIAMETER_M
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.posterior.posterior import posterior_text
from diagnosis.usual_tolerances import PAIR_SHARE, TRACK_SHARE, WHEEL_SHARE
from physics.bullet.open_loop import EMPTY
from physics.bullet.simulation import BulletSimulation
from pipeline.baselines.motion import WheelMotion
from sensors.wheels.odometry import Odometry
from symolo.core.random_streams import stream

Array = NDArray[np.float64]

ROW_S = 0.05
FIX_S = 10.0
FIX_SD = np.array([0.005, 0.005, np.radians(1.0)])
"""Standard deviations of a fix: x [m], y [m], yaw [rad]."""
SMOOTHED_ROWS = 5
USUAL = np.array([WHEEL_SHARE, PAIR_SHARE, TRACK_SHARE])
DRAWING = Odometry(np.pi * WHEEL_DIAMETER_M / ENCODER_TICKS_PER_REVOLUTION, TRACK_M)
RESAMPLES = 1000


@dataclass(frozen=True)
class Log:
    """Counts (N, 2), right and left, true poses (N, 3), and fixes (N, 3), nan where there is none."""

    counts: Array
    pose: Array
    fixes: Array

    @classmethod
    def from_counts(cls, counts: Array, pose: Array, rng: np.random.Generator) -> "Log":
        fixes = np.full(pose.shape, np.nan)
        rows = np.arange(0, len(pose), round(FIX_S / ROW_S))[1:]
        fixes[rows] = pose[rows] + FIX_SD * rng.standard_normal((len(rows), 3))
        return cls(counts, pose, fixes)


@dataclass(frozen=True)
class Variant:
    """A method: what it assumes of the wheels, and what it does with a fix."""

    shares: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Differences from the drawing: radius, right radius less left one, track."""
    sd: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slip_m_sqrt_m: float = 3e-4
    fix: str = "unused"
    """`unused`, `taken` as it is, or `filtered` by a Kalman filter."""
    rows: int = 1
    """Rows that are taken at once."""
    rolls: bool = True
    """Whether the counts are used."""

    def errors_m(self, log: Log) -> Array:
        """Return the errors of the place [m] at all rows that it takes."""
        motion = WheelMotion(DRAWING, self.slip_m_sqrt_m)
        state, covariance = np.concatenate([log.pose[0], self.shares]), np.zeros((6, 6))
        covariance[3:, 3:] = np.diag(np.square(self.sd))
        rows = np.arange(0, len(log.pose), self.rows)
        rolled = np.diff(log.counts[rows], axis=0) * DRAWING.metres_per_count * self.rolls
        fixes = np.array([_last_fix(log.fixes[a + 1 : b + 1]) for a, b in pairwise(rows)])
        errors = []
        for row, rolled_m, fix in zip(rows[1:], rolled, fixes, strict=True):
            if self.fix == "filtered":
                by_state, by_rolled = motion.jacobians(state, rolled_m)
                noise = (by_rolled * motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
                covariance = by_state @ covariance @ by_state.T + noise
            state = motion.moved(state, rolled_m)
            if self.fix == "taken" and np.isfinite(fix).all():
                state = np.concatenate([fix, state[3:]])
            if self.fix == "filtered" and np.isfinite(fix).all():
                state, covariance = _corrected(state, covariance, fix)
            errors.append(float(np.hypot(*(state[:2] - log.pose[row, :2]))))
        return np.array(errors)


def _last_fix(fixes: Array) -> Array:
    seen = fixes[np.isfinite(fixes).all(axis=1)]
    return seen[-1] if len(seen) else np.full(3, np.nan)


def _corrected(state: Array, covariance: Array, fix: Array) -> tuple[Array, Array]:
    off = fix - state[:3]
    off[2] = (off[2] + np.pi) % (2.0 * np.pi) - np.pi
    gain = covariance[:, :3] @ np.linalg.inv(covariance[:3, :3] + np.diag(FIX_SD**2))
    return state + gain @ off, covariance - gain @ covariance[:3]


def variants(shares: Array, slip_m_sqrt_m: float) -> Mapping[str, Variant]:
    """Return the methods, some of which know the fitted wheels and their slip."""
    radius, pair, track = shares.tolist()
    fitted, usual = (radius, pair, track), (USUAL[0], USUAL[1], USUAL[2])
    return {
        "odometry": Variant(),
        "odometry at 1 Hz": Variant(rows=20),
        "fitted radius": Variant((radius, 0.0, 0.0)),
        "fitted track": Variant((0.0, 0.0, track)),
        "fitted difference": Variant((0.0, pair, 0.0)),
        "fitted radius and track": Variant((radius, 0.0, track)),
        "fitted wheels": Variant(fitted),
        "fitted wheels at 1 Hz": Variant(fitted, rows=20),
        "last fix": Variant(fix="taken", rolls=False),
        "odometry from the last fix": Variant(fix="taken"),
        "fitted wheels from the last fix": Variant(fitted, fix="taken"),
        "filter": Variant(fix="filtered", sd=usual),
        "filter, fitted slip": Variant(fix="filtered", sd=usual, slip_m_sqrt_m=slip_m_sqrt_m),
        "filter, fitted wheels and slip": Variant(fitted, fix="filtered", slip_m_sqrt_m=slip_m_sqrt_m),
    }


def main() -> None:
    """Rank the methods on each of the three and print the correlations."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=Path)
    parser.add_argument("--runs", type=int, default=20, help="of each dataset")
    settings = parser.parse_args()
    measurement = IMPORTER.read(settings.recordings)
    fitted, judged = (_spread(half, settings.runs) for half in halves_of(measurement))
    robots, methods = _robots(replace(measurement, trials=halves_of(measurement)[0]), settings.runs)
    fleet = draw_robot(load_section("robot", "fleet"), 0, "ranking")[0]
    logs = {
        "recordings": [_recorded(trial) for trial in judged],
        "calibrated": [_driven(robot, trial, k) for k, (robot, trial) in enumerate(zip(robots, fitted, strict=True))],
        "fleet": [_driven(_as_drawn(fleet), trial, k) for k, trial in enumerate(fitted)],
    }
    errors = {name: _errors(methods, some) for name, some in logs.items()}
    print(f"median error over {settings.runs} runs [mm]")
    print(f"{'method':34s}" + "".join(f"{name:>12s}" for name in errors))
    for k, method in enumerate(methods):
        print(f"{method:34s}" + "".join(f"{1e3 * np.median(each[k]):12.1f}" for each in errors.values()))
    for name in ("calibrated", "fleet"):
        value, low, high = _correlation(errors["recordings"], errors[name])
        print(f"Spearman's correlation of the recordings with {name}: {value:.2f} ({low:.2f} to {high:.2f})")


def _spread(trials: Sequence[Trial], count: int) -> list[Trial]:
    """Return a number of trials, evenly spread over all."""
    return [trials[k] for k in np.linspace(0, len(trials) - 1, count).round().astype(int)]


def _robots(fitted: Measurement, count: int) -> tuple[list[RobotConfig], Mapping[str, Variant]]:
    """Return robots that are drawn from the diagnosis of some runs, and the methods that know its fitted numbers."""
    with TemporaryDirectory() as folder:
        (Path(folder) / FILE).write_text(posterior_text(diagnose(fitted)))
        loaded = load_scenario("smoke", [f"like={folder}"])
    robots = [draw_run(loaded, "CW", number + 1).robot for number in range(count)]
    known = dict(datasets(loaded))["point"]
    return robots, variants(known.mean, known.slip_m_sqrt_m)


def _as_drawn(robot: RobotConfig) -> RobotConfig:
    """Return a robot with wheels, track and encoders as in the drawing of the real one."""
    robot = robot.with_section("drive", {"wheel_diameter_m": WHEEL_DIAMETER_M, "track_m": TRACK_M})
    robot = robot.with_section("chassis", {"width_m": 0.222})
    return robot.with_section("encoder", {"counts_per_revolution": round(ENCODER_TICKS_PER_REVOLUTION)})


def _recorded(trial: Trial) -> Log:
    logged = {channel.name: channel.series.values for channel in trial.channels}
    pose = np.stack([logged[name] for name in ("x_m", "y_m", "theta_rad")], axis=1)
    counts = np.stack([logged[f"enc_{side}_ticks"] for side in ("right", "left")], axis=1)
    return Log.from_counts(counts, pose, stream(3, "fixes", trial.name))


def _driven(robot: RobotConfig, trial: Trial, number: int) -> Log:
    """Return a drive in PyBullet whose wheels turn as fast as those of a recorded run."""
    counts = _recorded(trial).counts
    turned = np.diff(counts, axis=0) * 2.0 * np.pi / ENCODER_TICKS_PER_REVOLUTION / ROW_S
    kernel = np.ones(SMOOTHED_ROWS) / SMOOTHED_ROWS
    speeds = np.stack([np.convolve(column, kernel, "same") for column in turned.T], axis=1)
    rates = Rates()
    rows = []
    with BulletSimulation(robot, EMPTY, (0.0, 0.0, 0.0), rates, stream(2, "wheels", number)) as world:
        rows.append((*world.encoder_counts(), *world.pose()))
        for right, left in speeds.tolist():
            world.set_wheel_speeds(right, left)
            world.advance(round(ROW_S * rates.physics_hz))
            rows.append((*world.encoder_counts(), *world.pose()))
    logged = np.array(rows, dtype=np.float64)
    return Log.from_counts(logged[:, :2], logged[:, 2:], stream(3, "fixes", number))


def _errors(methods: Mapping[str, Variant], logs: Sequence[Log]) -> Array:
    """Return the root mean square errors [m] of all methods in all runs, (M, R)."""
    return np.array([[np.sqrt(np.nanmean(method.errors_m(log) ** 2)) for log in logs] for method in methods.values()])


def _correlation(some: Array, others: Array) -> tuple[float, float, float]:
    """Return Spearman's correlation of the medians, and its 95 % interval over the runs."""
    rng = np.random.default_rng(4)

    def of(a: Array, b: Array) -> float:
        return float(spearmanr(np.median(a, axis=1), np.median(b, axis=1)).statistic)

    def resampled(errors: Array) -> Array:
        return errors[:, rng.integers(errors.shape[1], size=errors.shape[1])]

    drawn = [of(resampled(some), resampled(others)) for _ in range(RESAMPLES)]
    low, high = np.quantile(drawn, [0.025, 0.975]).tolist()
    return of(some, others), low, high


if __name__ == "__main__":
    main()
