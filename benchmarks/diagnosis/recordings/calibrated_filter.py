"""A Kalman filter whose noise comes from a calibrated dataset, judged on sessions of a real robot that were not fitted.

    python benchmarks/diagnosis/recordings/calibrated_filter.py FOLDER

The robot of OptiOdom logs (FOLDER: counts of two wheels and poses of a motion capture) is diagnosed on every second
session of each kind of path, and posterior.yaml is made from it. The other sessions are judged, and then the other way
round: an extended Kalman filter predicts the pose from the first one and the counts alone, and its error is compared
with its covariance.

The filter has the mean and the covariance of radius, difference of radii and track as unknown constants of a robot
(`pipeline.baselines.motion`). They come from 400 robots of a dataset:

    posterior     drawn together from posterior.yaml, as `--like` does, with the random slip of the wheels
    usual slip    the same robots with the slip that other filters of symolo assume
    independent   as posterior, without the correlations
    point         the fitted robot alone
    uniform       uniform within +-1.73 usual tolerances around the drawing, so with the tolerance as standard deviation
    fleet         the shipped robot `fleet`, whose wheels are those of the drawing

NEES is the mean of the squared Mahalanobis distance over three, 1 for a filter that knows its error; the share is that
of the poses inside the 95 % region. The first metre of each run is left out. The rms error is that of the place at the
ends of the runs.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from configs.loader import LoadedScenario, load_scenario
from configs.posterior.drawing import drawn_hypothesis, drawn_robot, mean_robot
from configs.posterior.schema import FILE
from diagnosis.diagnose import diagnose
from diagnosis.importers.optiodom import ENCODER_TICKS_PER_REVOLUTION, IMPORTER, TRACK_M, WHEEL_DIAMETER_M
from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.posterior.posterior import posterior_text
from diagnosis.usual_tolerances import PAIR_SHARE, TRACK_SHARE, WHEEL_SHARE
from pipeline.baselines.motion import WheelMotion
from pipeline.baselines.robot_knowledge import SLIP_M_SQRT_M
from sensors.wheels.odometry import Odometry
from symolo.core.random_streams import stream
from symolo.core.yaml.tree import Node

Array = NDArray[np.float64]

ROBOTS = 400
USUAL = np.array([WHEEL_SHARE, PAIR_SHARE, TRACK_SHARE])
START_SD = np.array([5e-4, 5e-4, 5e-3])
"""Standard deviations of the first pose, from one frame of the cameras; the heading may be mounted askew [m, rad]."""
FROM_M = 1.0
STEPS = 5
"""Rows of 50 ms that the filter takes at once."""


@dataclass(frozen=True)
class Robots:
    """What a dataset says of its robots: mean (3,) and covariance (3, 3) of the shares, and the error of a wheel."""

    mean: Array
    covariance: Array
    slip_m_sqrt_m: float = SLIP_M_SQRT_M


@dataclass(frozen=True)
class Judged:
    """One run: squared distances of its poses, and the error of the place at its end."""

    squared: Array
    end_m: float


def main() -> None:
    """Fit, judge and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=Path)
    settings = parser.parse_args()
    measurement = IMPORTER.read(settings.recordings)
    halves = halves_of(measurement)
    for fitted, judged in (halves, halves[::-1]):
        _compare(replace(measurement, trials=fitted), judged)


def _compare(fitted: Measurement, judged: Sequence[Trial]) -> None:
    """Fit a robot to some runs, judge the filters on others, and print a table."""
    diagnosis = diagnose(fitted)
    with TemporaryDirectory() as folder:
        (Path(folder) / FILE).write_text(posterior_text(diagnosis))
        loaded = load_scenario("smoke", [f"like={folder}"])
    print(f"{len(fitted.trials)} runs of {len({t.session for t in fitted.trials})} sessions to fit, ", end="")
    print(f"{len(judged)} runs of {len({t.session for t in judged})} sessions to judge")
    print(f"named: {', '.join(diagnosis.names) or 'no effect'}")
    print(f"{'robots':14s} {'slip [mm]':>9s} {'NEES':>6s} {'inside 95 %':>12s} {'rms at the ends [mm]':>21s}")
    for name, robots in datasets(loaded):
        results = [_judged(trial, robots) for trial in judged]
        squared = np.concatenate([result.squared for result in results])
        inside = (squared <= chi2.ppf(0.95, 3)).mean()
        ends_mm = 1e3 * np.sqrt(np.mean([result.end_m**2 for result in results]))
        slip = f"{1e3 * robots.slip_m_sqrt_m:.2f}"
        print(f"{name:14s} {slip:>9s} {squared.mean() / 3.0:6.2f} {100.0 * inside:10.1f} % {ends_mm:21.1f}", flush=True)
    print()


def halves_of(measurement: Measurement) -> tuple[tuple[Trial, ...], tuple[Trial, ...]]:
    """Return the runs of every second session of each kind of path, and those of the others."""
    sessions: dict[str, list[str]] = {}
    for trial in measurement.trials:
        kind_sessions = sessions.setdefault(trial.name.split("/")[0], [])
        kind_sessions += [trial.session] if trial.session not in kind_sessions else []
    fitted = {session for kind_sessions in sessions.values() for session in sorted(kind_sessions)[::2]}
    parts = [tuple(t for t in measurement.trials if (t.session in fitted) is chosen) for chosen in (True, False)]
    return parts[0], parts[1]


def datasets(loaded: LoadedScenario) -> Iterator[tuple[str, Robots]]:
    """Yield each dataset with what it says of its robots."""
    like, single = loaded.like, loaded.single_routes["CW"]
    assert like is not None  # noqa: S101 - named above
    root, values = single.root, {path: item.ends()[0] for path, item in single.distributions.items()}
    robots, slips = [], []
    for number in range(ROBOTS):
        hypothesis = drawn_hypothesis(like, stream(1, "hypothesis", number))
        robot = drawn_robot(root, hypothesis, values, stream(1, "robot", number)).on(root)
        robots.append(_shares(robot))
        slips.append(_number(robot, "effects.random_slip.slip_m_sqrt_m", 0.0))
    mean, covariance, slip = np.mean(robots, axis=0), np.cov(np.array(robots).T), float(np.mean(slips))
    yield "posterior", Robots(mean, covariance, slip)
    yield "usual slip", Robots(mean, covariance)
    yield "independent", Robots(mean, covariance * np.eye(3), slip)
    point = mean_robot(like.hypotheses[0]).on(root)
    yield "point", Robots(_shares(point), np.zeros((3, 3)), _number(point, "effects.random_slip.slip_m_sqrt_m", 0.0))
    yield "uniform", Robots(np.zeros(3), np.eye(3) * USUAL**2)
    yield "fleet", Robots(np.zeros(3), np.zeros((3, 3)))


def _shares(root: Node) -> Array:
    """Return by how much radius, difference of radii and track of a robot differ from the drawing, as shares."""
    scale = _number(root, "effects.wheel_radius_scale.scale") / _number(root, "effects.encoder_ticks_scale.scale")
    radius = _number(root, "drive.wheel_diameter_m", 0.0) * scale / WHEEL_DIAMETER_M
    track = _number(root, "drive.track_m", 0.0) * _number(root, "effects.wheelbase_scale.scale") / TRACK_M
    # The filter has the right wheel less the left one, and the effect has the left one less the right one.
    return np.array([radius - 1.0, -_number(root, "effects.wheel_radius_asymmetry.asymmetry", 0.0), track - 1.0])


def _number(root: Node, path: str, absent: float = 1.0) -> float:
    value = root.plain_at(("robot", *path.split(".")))
    return absent if value is None else float(value)


def _judged(trial: Trial, robots: Robots) -> Judged:
    """Return the errors of the filter in one run."""
    logged = {channel.name: channel.series.values for channel in trial.channels}
    pose = np.stack([logged[name] for name in ("x_m", "y_m", "theta_rad")], axis=1)
    counts = np.stack([logged[f"enc_{side}_ticks"] for side in ("right", "left")], axis=1)
    odometry = Odometry(np.pi * WHEEL_DIAMETER_M / ENCODER_TICKS_PER_REVOLUTION, TRACK_M)
    motion, state = WheelMotion(odometry, robots.slip_m_sqrt_m), np.concatenate([pose[0], robots.mean])
    covariance = np.zeros((6, 6))
    covariance[:3, :3], covariance[3:, 3:] = np.diag(START_SD**2), robots.covariance
    rows = np.arange(0, len(pose), STEPS)
    rolled = np.diff(counts[rows], axis=0) * odometry.metres_per_count
    squared, travelled = [], 0.0
    for row, rolled_m in zip(rows[1:], rolled, strict=True):
        by_state, by_rolled = motion.jacobians(state, rolled_m)
        noise = (by_rolled * motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        covariance = by_state @ covariance @ by_state.T + noise
        state = motion.moved(state, rolled_m)
        travelled += float(np.abs(rolled_m).mean())
        error = state[:3] - pose[row]
        error[2] = (error[2] + np.pi) % (2.0 * np.pi) - np.pi
        if travelled >= FROM_M and np.isfinite(error).all():
            squared.append(float(error @ np.linalg.solve(covariance[:3, :3], error)))
    return Judged(np.array(squared), float(np.hypot(*(state[:2] - pose[rows[-1], :2]))))


if __name__ == "__main__":
    main()
