"""Residuals of the nominal simulator in the three stages (wheels, pose, ranges), without noise.

Each stage is driven by what was logged upstream. The reference run fixes voltages, wheel angles and true path.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.diagnosis.independent_cases.disturbances import whitened
from benchmarks.diagnosis.independent_cases.drives import wheels as drive_wheels
from benchmarks.diagnosis.independent_cases.drives.effects import body_motion, counted, true_geometry, wheel_travel
from benchmarks.diagnosis.independent_cases.drives.outside import WHEELS
from benchmarks.diagnosis.independent_cases.drives.robot import SENSORS
from benchmarks.diagnosis.independent_cases.drives.room import cast, corner_distance, sensor_ray
from benchmarks.diagnosis.independent_cases.drives.sensors import logged_pose, ranges
from benchmarks.diagnosis.independent_cases.drives.simulation import Run
from benchmarks.diagnosis.independent_cases.drives.wheels import FINE_S, ROW_S, SUB
from benchmarks.diagnosis.independent_cases.motors.motor_effects import PLACES
from benchmarks.diagnosis.independent_cases.ranges.errors import noise_sd, wander_covariance
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Mask, Variant

if TYPE_CHECKING:
    from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting

WINDOW = 10  # rows of a pose increment
BLOCK = 200  # rows of ranges that are made white together


def shown_speeds(variant: Variant, speeds: Array) -> Array:
    """Return wheel speeds (..., 2) in rad/s as encoders show them with the nominal counts per turn."""
    return counted(variant.effects, speeds * ROW_S, ROW_S, 2 * np.pi) / ROW_S


def _sums(steps: Array) -> Array:
    """Return the sums of steps along the second axis from zero on."""
    return np.concatenate([np.zeros_like(steps[:, :1]), np.cumsum(steps, axis=1)], axis=1)


def true_path(setting: "DriveSetting", variant: Variant, run: Run, trials: Sequence[int]) -> Array:
    """Return the path (trials, fine steps + 1, 3) without slip that the geometry makes of the wheel angles of a run."""
    angles, poses = run.angles[trials], run.poses[trials]
    individual = variant.individual(setting.individual, setting.robot.all_nominal)
    session = np.repeat(setting.session_s[trials, :-1], SUB, axis=1)
    g = true_geometry(individual, variant.effects, variant.outside, session)
    middle = 0.5 * (angles[:, 1:] + angles[:, :-1])
    travel = wheel_travel(g, np.diff(angles, axis=1), middle, poses[:, :-1, 0], poses[:, :-1, 1])
    ds, spun, creep_x, creep_y = body_motion(g, travel, FINE_S)
    theta = poses[:, :1, 2] + _sums(spun)
    heading = theta[:, :-1] + 0.5 * spun
    x = poses[:, :1, 0] + _sums(ds * np.cos(heading) + creep_x)
    y = poses[:, :1, 1] + _sums(ds * np.sin(heading) + creep_y)
    return np.stack([x, y, theta], axis=-1)


def increments(path: Array) -> Array:
    """Return the motion over windows of 10 rows in the body frame of the first row, (trials, windows, 3)."""
    first, last = path[:, :-WINDOW:WINDOW], path[:, WINDOW::WINDOW]
    d = last - first
    c, s = np.cos(first[..., 2]), np.sin(first[..., 2])
    return np.stack([c * d[..., 0] + s * d[..., 1], -s * d[..., 0] + c * d[..., 1], d[..., 2]], axis=-1)


def dead_reckoned(setting: "DriveSetting", counts: Array) -> Array:
    """Return the path (trials, rows, 3) from encoder counts by the mid-point rule, with nominal lengths, from zero."""
    robot = setting.robot
    travel = np.diff(counts, axis=1) * (2 * np.pi / robot.ticks * robot.radius_m)
    ds, spun = 0.5 * (travel[..., 0] + travel[..., 1]), (travel[..., 1] - travel[..., 0]) / robot.track_m
    theta = _sums(spun)
    heading = theta[:, :-1] + 0.5 * spun
    return np.stack([_sums(ds * np.cos(heading)), _sums(ds * np.sin(heading)), theta], axis=-1)


def pose_sigma(setting: "DriveSetting", angles: Array) -> Array:
    """Return the standard deviations (trials, windows, 3) of the increments in m, m, rad.

    The formula is that of the format, with the true noise of the pose.
    """
    robot = setting.robot
    travel = np.abs(np.diff(angles[:, ::SUB], axis=1)).mean(axis=-1) * robot.radius_m
    windows = travel.shape[1] // WINDOW
    length = travel[:, : windows * WINDOW].reshape(len(travel), windows, WINDOW).sum(axis=-1)
    q = setting.travel_noise**2 * length
    xy = 2 * setting.xy_sd_m**2 + (0.12 * setting.theta_sd_rad) ** 2 + q / 2
    theta = 2 * setting.theta_sd_rad**2 + 2 * q / robot.track_m**2
    return np.sqrt(np.stack([xy, xy, theta], axis=-1))


def nominal_ranges(setting: "DriveSetting", pose: Array) -> tuple[Array, Mask]:
    """Return nominal readings (m), (trials, rows, 3), from logged poses, and whether they are clear of corners."""
    robot = setting.robot
    distances, clear = [], []
    for sensor in SENSORS:
        ray = sensor_ray(pose, robot.mounts[sensor])
        d, _ = cast(ray, robot.room)
        distances.append(d)
        clear.append(corner_distance(ray, robot.room) > 0.02 + 0.05 * d)
    return np.stack(distances, axis=-1), np.stack(clear, axis=-1)


def range_sigma(setting: "DriveSetting", pose: Array) -> Array:
    """Return the noise (m) of the range residuals: reading noise, rounding, and pose noise propagated."""
    robot, step = setting.robot, 1e-4
    base, _ = nominal_ranges(setting, pose)
    reading_sd = noise_sd(base, robot.polynomial_mm, robot.origin_m) * setting.range_factor
    variance = reading_sd**2 + 1e-6 / 12
    for axis, sd in enumerate((setting.xy_sd_m, setting.xy_sd_m, setting.theta_sd_rad)):
        moved = pose.copy()
        moved[..., axis] += step
        change = (nominal_ranges(setting, moved)[0] - base) / step
        variance = variance + (np.clip(change, -20, 20) * sd) ** 2
    return np.sqrt(variance)


def usable_ranges(setting: "DriveSetting", pose: Array) -> tuple[Array, Mask]:
    """Return nominal readings (m) and whether they are clear of corners and of the largest range."""
    expected, clear = nominal_ranges(setting, pose)
    return expected, clear & (expected < setting.robot.max_range_m - 0.03)


def _moves_wheels(variant: Variant) -> bool:
    """Return whether the wheel speeds that the encoders show differ from those of the plain robot."""
    return (
        bool(set(variant.shifts) & {"R", "K", "B", "Tc", "J"})
        or any(name in PLACES or name.startswith("encoder") for name, _ in variant.effects)
        or any(name in WHEELS for name, _ in variant.outside)
    )


def _wheel_signatures(
    setting: "DriveSetting", reference: Run, variants: Sequence[Variant], trials: Sequence[int]
) -> Array:
    """Return white wheel speeds in standard deviations, (variants, values)."""
    chosen = [i for i, variant in enumerate(variants) if _moves_wheels(variant)]
    robots = [Variant(), *(variants[i] for i in chosen)]
    speeds = drive_wheels.run(setting, robots, trials, reference.u_V, reference.poses[:, ::SUB])
    every = np.repeat(speeds[:1], len(variants), axis=0)
    every[chosen] = speeds[1:]
    shown = np.stack([shown_speeds(variant, s) for variant, s in zip(variants, every, strict=True)])
    z = shown / setting.wheel.true_rad_s
    return np.moveaxis(whitened(np.moveaxis(z, -2, -1), setting.wheel.lag1), -1, -2).reshape(len(variants), -1)


def _white_ranges(z: Array, sd: Array, usable: Mask, noise_effects: Sequence[Effect]) -> Array:
    """Return range residuals z (variants, trials, rows, sensors) with a range_wander taken out, in blocks of 200 rows.

    sd (m) and usable are (trials, rows, sensors).
    """
    for _, p in noise_effects:
        for trial, first, sensor in np.ndindex(z.shape[1], -(-z.shape[2] // BLOCK), z.shape[3]):
            block = slice(first * BLOCK, min((first + 1) * BLOCK, z.shape[2]))
            t = np.arange(block.stop - block.start) * ROW_S
            share = usable[trial, block, sensor] / sd[trial, block, sensor]
            slow = wander_covariance(t, p["sd_m"], p["time_constant_s"]) * np.outer(share, share)
            lower = np.linalg.cholesky(np.eye(len(t)) + slow)
            z[:, trial, block, sensor] = np.linalg.solve(lower, z[:, trial, block, sensor].T).T
    return z


def stage_signatures(
    setting: "DriveSetting", reference: Run, variants: Sequence[Variant], noise_effects: Sequence[Effect]
) -> Array:
    """Return white residuals of the fit trials in all stages in standard deviations, (variants, values)."""
    trials = list(range(setting.fit_trials))
    angles, poses = reference.angles[trials], reference.poses[trials]
    parts = [_wheel_signatures(setting, reference, variants, trials)] if setting.voltages_logged else []
    base_pose = logged_pose(Variant(), poses, trials)
    _, usable = usable_ranges(setting, base_pose)
    sigma, sd_range = pose_sigma(setting, angles), range_sigma(setting, base_pose)
    z_pose, z_range = [], []
    for variant in variants:
        turned = counted(variant.effects, np.diff(angles, axis=1), FINE_S, setting.robot.ticks)
        tracked = logged_pose(variant, true_path(setting, variant, reference, trials), trials)
        z_pose.append((increments(tracked) - increments(dead_reckoned(setting, _sums(turned)[:, ::SUB]))) / sigma)
        expected, _ = nominal_ranges(setting, logged_pose(variant, poses, trials))
        reading, _ = ranges(setting, variant, poses, trials)
        z_range.append(np.where(usable, reading - expected, 0.0) / sd_range)
    # A ray that crosses a corner jumps by metres, which counts no more than 50 standard deviations.
    white = _white_ranges(np.clip(np.stack(z_range), -50, 50), sd_range, usable, noise_effects)
    parts += [np.stack(z_pose).reshape(len(variants), -1), white.reshape(len(variants), -1)]
    return np.concatenate(parts, axis=1)
