"""Encoder ticks -> changes of the pose over ten rows, in the frame of the body at the first row.

Windows begin at every fifth row, so that each row is in two of them: twice as many measured poses are used as with
adjacent windows, and neighbours have no pose in common. They share half of the slip noise, which is a few per cent of
the total. A window and the next but one share a pose, at the end of the one and at the start of the other. Its noise
cancels in slow structure, and adds up in structure that turns over between the two.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import KnownWheels
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Covariate, CovariateShape, Observed, Predicted, SharedReading
from diagnosis.predictors.distinct import distinct
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.pose.heading_error import PASSES, error_along_path, heading_error_rad, turned_by
from diagnosis.predictors.pose.lost_counts import lost_counts
from diagnosis.predictors.pose.motion_starts import start_covariates
from diagnosis.predictors.pose.pose_noise import PoseNoise
from diagnosis.predictors.pose.reversals import body_rates, reversal_covariates
from diagnosis.predictors.pose.wheel_slip import PATCH, CountedMotion, slip_functions
from diagnosis.predictors.pose.window_noise import window_noise
from diagnosis.predictors.rows import (
    bridged,
    good_values,
    held_out_rows,
    joined,
    rows_after,
    session_time_s,
    trial_covariate,
    trial_of_rows,
)
from physics.drivetrain.wheel_turns import true_turns
from physics.robot.floor_place import FloorPlace
from physics.robot.model import RobotModel, applied
from physics.robot.stack import stackable_groups, stacked, stacked_effects
from symolo.core.arrays import Array

WINDOW, STRIDE = 10, 5
SHARE_NO_POSE = WINDOW // STRIDE + 1
"""Number of windows to the next one that begins after the end of this one."""
LEVER_M = 0.12
"""Lever arm by which noise of the heading is noise of the place."""
PARTS = ("drive", "encoder")
SLOTS = frozenset(
    {
        Slot.GEOMETRY,
        Slot.ROLLING,
        Slot.TRAVEL,
        Slot.CREEP,
        Slot.GROUND,
        Slot.TURNING,
        Slot.ENCODER,
        Slot.COUNTING,
        Slot.POSE_POINT,
        Slot.POSE_HEADING,
        Slot.POSE_DELAY,
    }
)
"""Slots of the effects between the counts and the logged poses."""
SIDES = ("right", "left")
COMPONENTS = (("pose_dx_m", "m"), ("pose_dy_m", "m"), ("pose_dtheta_rad", "rad"))
READINGS = (4, 4, 2)
"""Number of logged readings that each component consists of: x and y, or the heading, of two poses."""


class Pose:
    """The windows of the case format: mid-point rule, and effects for slip, tracked point and pose delay."""

    name = "pose"
    at_once = 48
    parts, slots = PARTS, SLOTS
    """Parts of the robot, and slots of the effects, that act on the stage."""
    channels = ("pose_increment",) * len(COMPONENTS)
    """Name of each component in an answer."""
    has_wheels = True
    """Whether the log has the turns of the wheels."""

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        self._trials = [len(trial.t_s) for trial in measurement.trials]
        self._t_s = joined(trial.t_s for trial in measurement.trials)
        ticks = self._counts(measurement, nominal)
        whole = np.isfinite(ticks).all(axis=-1)
        self._ticks = bridged(ticks, self._t_s, self._trials)
        self._steps_s = np.maximum(np.diff(self._t_s, prepend=self._t_s[0]), 0.0)
        self._starts = np.cumsum([0, *self._trials[:-1]])
        # The first row of a trial has no row before it. Any positive time will do, since its wheels have not turned.
        self._steps_s[self._starts] = 1.0
        self._counted = np.diff(self._ticks, axis=0, prepend=self._ticks[:1])
        self._counted[self._starts] = 0.0
        self._first, self._last = rows_after(measurement, WINDOW, STRIDE)
        logged = bridged(np.stack([good_values(measurement, name) for name in POSE], axis=-1), self._t_s, self._trials)
        self._heading_rad = logged[:, 2]
        self._since_on_s = session_time_s(measurement)
        self._place = self._places(logged)
        missing = np.concatenate([[0], np.cumsum(~whole)])
        self._complete = missing[self._last + 1] == missing[self._first]
        self.observed: tuple[Observed, ...] = self._observed(measurement, nominal)

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        distinct_robots, which = distinct(robots, self.parts, self.slots)
        increments = np.empty((len(distinct_robots), len(self._first), 3))
        for group in stackable_groups(distinct_robots):
            increments[group] = self._increments(self._paths([distinct_robots[k] for k in group]))
        return tuple(Predicted(increments[which, :, k], observed.sd) for k, observed in enumerate(self.observed))

    def path(self, robot: RobotConfig, starts: Array) -> Array:
        """Return the poses of all rows as logged, (n, 3), predicted from the first pose of each trial and the ticks.

        Args:
            robot: The robot.
            starts: (N, 3), logged x [m], y [m], yaw [rad] in the first row of each trial.
        """
        from_w = np.repeat(starts, self._trials, axis=0)
        place, in_w = self._places(from_w), from_w
        # Where the robot is depends on what the places do to it: each pass is right for longer.
        for _ in range(PASSES if robot.effects.in_slots({Slot.TRAVEL, Slot.TURNING}) else 1):
            path = self._paths([robot], starts, place)
            begin = np.repeat(path[self._starts], self._trials, axis=0)
            in_w = from_w + seen_from_body(begin[:, 2] - from_w[:, 2], path - begin)
            place = self._places(in_w)
        return in_w

    def wheel_speeds_rad_s(self, robot: RobotConfig) -> Array:
        """Return the mean speeds of the right and the left wheel in each window, by their counts, (m, 2)."""
        turned = 2.0 * pi / robot.encoder.counts_per_revolution * (self._ticks[self._last] - self._ticks[self._first])
        return turned / (self._t_s[self._last] - self._t_s[self._first])[:, None]

    def travel_m(self, robot: RobotConfig) -> Array:
        """Return the mean distance (n,) that both wheels have travelled since the row before."""
        turned = 2.0 * pi / robot.encoder.counts_per_revolution * np.abs(self._counted)
        return 0.5 * robot.drive.wheel_diameter_m * turned.mean(axis=-1)

    def by_rows(self, window_values: Array) -> Array:
        """Return values (m,) of the windows at all rows, (n,), interpolated between the middles of windows."""
        values = np.zeros(len(self._t_s))
        middle = 0.5 * (self._first + self._last)
        for start, rows in zip(self._starts.tolist(), self._trials, strict=True):
            inside = (self._first >= start) & (self._first < start + rows)
            if inside.any():
                number = np.arange(start, start + rows)
                values[number] = np.interp(number, middle[inside], window_values[inside])
        return values

    @property
    def trials(self) -> tuple[int, ...]:
        """Number of rows of each trial."""
        return tuple(self._trials)

    def _increments(self, poses: Array) -> Array:
        """Return the changes (..., m, 3) of poses (..., n, 3) over each window, in the frame of its first pose."""
        first, last = poses[..., self._first, :], poses[..., self._last, :]
        return seen_from_body(first[..., 2], last - first)

    def _places(self, pose: Array) -> FloorPlace:
        """Return the places (n, 1) in the middle of each row's motion, by poses (n, 3) in W."""
        before = np.maximum(np.arange(len(pose)) - 1, np.repeat(self._starts, self._trials))
        middle = 0.5 * (pose + pose[before])
        time_s = self._since_on_s - 0.5 * (self._since_on_s - self._since_on_s[before])
        return FloorPlace(middle[:, :1], middle[:, 1:2], time_s[:, None])

    def _paths(
        self, robots: Sequence[RobotConfig], starts: Array | None = None, place: FloorPlace | None = None
    ) -> Array:
        """Return the tracked poses at the logged times, (n, 3) or (M, n, 3), each trial from the axle at zero.

        Args:
            robots: M robots that are alike.
            starts: (N, 3), logged poses in the first row of each trial, if there are no others.
            place: Places of the rows; those of the log by default.
        """
        place = place or self._place
        # Robots that differ in other effects only are predicted once, so these must not act.
        robots = [_with_slots(robot, self.slots) for robot in robots]
        model = RobotModel.from_config(stacked(robots, axes=2))
        turned = self._turned(model, place)
        steps = self._steps(model, turned, place)
        pose = np.zeros((*steps.shape[:-1], 3))
        for start, rows in zip(self._starts.tolist(), self._trials, strict=True):
            part = slice(start, start + rows)
            forward, turn = steps[..., part, 0], steps[..., part, 1]
            yaw = np.cumsum(turn, axis=-1)
            middle = yaw - 0.5 * turn
            pose[..., part, 0] = np.cumsum(forward * np.cos(middle), axis=-1)
            pose[..., part, 1] = np.cumsum(forward * np.sin(middle), axis=-1)
            pose[..., part, 2] = yaw
        effects = stacked_effects(robots, axes=1)
        delay_s = applied(effects.functions(Slot.POSE_DELAY), 0.0, self._t_s) - self._age_s(robots)
        if model.functions(Slot.CREEP):
            as_logged = earlier(pose, self._t_s, self._trials, delay_s)
            pose = pose + self._crept(model, turned, as_logged[..., 2], starts)
        pose = earlier(pose, self._t_s, self._trials, delay_s)
        tracked = applied(model.functions(Slot.POSE_POINT), pose)
        if functions := effects.functions(Slot.POSE_HEADING):
            askew_rad, time_s = self._askew_rad(model), self._since_on_s
            if starts is None:
                error_rad = heading_error_rad(functions, self._heading_rad - askew_rad, time_s)
            else:
                first_rad, first_s = (np.repeat(each, self._trials) for each in (starts[:, 2], time_s[self._starts]))
                turned_rad = tracked[..., 2] - askew_rad
                error_rad = error_along_path(functions, turned_rad, first_rad - askew_rad, first_s, time_s)
            tracked = turned_by(tracked, error_rad)
        return tracked

    def _askew_rad(self, model: RobotModel) -> Array:
        """Return by how much the tracked body is turned on the robot, (1,) or (M, 1)."""
        return applied(model.functions(Slot.POSE_POINT), np.zeros((1, 3)))[..., 2]

    def _counts(self, measurement: Measurement, nominal: RobotConfig) -> Array:
        """Return the counts of the right and the left wheel in all rows, (n, 2); NaN where missing."""
        del nominal
        return np.stack([good_values(measurement, f"enc_{side}_ticks") for side in SIDES], axis=-1)

    def _age_s(self, robots: Sequence[RobotConfig]) -> float | Array:
        """Return the age of the counts when their row is logged, one or (M, 1)."""
        del robots
        return 0.0

    def _added_variance(self, measurement: Measurement) -> tuple[float | Array, float | Array]:
        """Return the variance of distance [m2] and turn [rad2] of each window by noise of the log, one or (m,)."""
        del measurement
        return 0.0, 0.0

    def _turned(self, model: RobotModel, place: FloorPlace) -> Array:
        """Return turns [rad] of right and left wheel since the previous row, by which round wheels would travel as far
        as those of the robot do, (n, 2) or (M, n, 2).
        """
        rad_per_count = 2.0 * pi / model.counts_per_revolution
        turned = true_turns(model, rad_per_count * self._counted, self._steps_s[:, None])
        share = applied(model.functions(Slot.TRAVEL), np.ones_like(turned), place)
        if not (rolling := model.functions(Slot.ROLLING)):
            return turned * share
        total = np.cumsum(turned, axis=-2)
        since_start = total - np.repeat(total[..., self._starts, :], self._trials, axis=-2)
        angle_rad = rad_per_count * np.repeat(self._ticks[self._starts], self._trials, axis=0) + since_start
        return turned * applied(rolling, np.ones_like(turned), angle_rad - 0.5 * turned, turned) * share

    def _crept(self, model: RobotModel, turned: Array, yaw_rad: Array, starts: Array | None) -> Array:
        """Return by how much the robot has crept over the floor, in the frame of each trial's path, (..., n, 3).

        The creep has a direction in the room. The path begins at a heading of zero, and where it points in the room is
        known best from the logged headings: its own drift with the errors of the wheels.

        Args:
            model: The robots.
            turned: Turns of the wheels, (..., n, 2).
            yaw_rad: Yaw of the path (..., n) at the times of the logged headings, which may be late.
            starts: (N, 3), logged poses in the first row of each trial, if there are no others.
        """
        geometry = model.geometry
        right_m, left_m = geometry.right_radius_m * turned[..., :1], geometry.left_radius_m * turned[..., 1:]
        rolled_m, middle_m = 0.5 * (np.abs(right_m) + np.abs(left_m)), 0.5 * np.abs(right_m + left_m)
        crept_m = applied(model.functions(Slot.CREEP), np.zeros((*rolled_m.shape[:-1], 2)), rolled_m, middle_m)
        askew_rad = self._askew_rad(model)
        if starts is None:
            frame_rad = self._heading_rad - askew_rad - yaw_rad
        else:
            frame_rad = np.repeat(starts[:, 2], self._trials) - askew_rad
        steps = np.concatenate([crept_m, np.zeros_like(crept_m[..., :1])], axis=-1)
        total = np.cumsum(seen_from_body(frame_rad, steps), axis=-2)
        return total - np.repeat(total[..., self._starts, :], self._trials, axis=-2)

    def _steps(self, model: RobotModel, turned: Array, place: FloorPlace) -> Array:
        """Return distance forward [m] and turn [rad] of each row since the previous one, (n, 2) or (M, n, 2)."""
        geometry = model.geometry
        right_m, left_m = geometry.right_radius_m * turned[..., :1], geometry.left_radius_m * turned[..., 1:]
        forward_m, turn_rad = 0.5 * (right_m + left_m), (right_m - left_m) / geometry.track_m
        step_s = self._steps_s[:, None]
        share = applied(model.functions(Slot.GROUND), np.ones_like(turn_rad), forward_m / step_s, turn_rad / step_s)
        share = applied(model.functions(Slot.TURNING), share, place)
        return np.concatenate(np.broadcast_arrays(forward_m, turn_rad * share), axis=-1)

    def _observed(self, measurement: Measurement, nominal: RobotConfig) -> tuple[Observed, ...]:
        log = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
        first, last = self._first, self._last
        values, predicted = self._increments(log), self._increments(self._paths([nominal]))
        middle = (first + last) // 2
        angle_rad = 2.0 * pi / nominal.encoder.counts_per_revolution * self._ticks[middle]
        trial = trial_of_rows(measurement)[first]
        moved_m = np.copysign(np.hypot(predicted[:, 0], predicted[:, 1]), predicted[:, 0])
        lasts_s = self._t_s[last] - self._t_s[first]
        rates = body_rates(measurement, self._ticks, self._steps_s, nominal)
        covariates = (
            Covariate("ds", moved_m, as_rate=("v_m_s", lasts_s)),
            Covariate("dtheta", predicted[:, 2], as_rate=("w_rad_s", lasts_s)),
            *reversal_covariates(rates, self._trials, (first, last)),
            *start_covariates(rates, self._steps_s, self._trials, (first, last)),
            Covariate("theta_rad", log[middle, 2], CovariateShape.PERIODIC),
            Covariate("position", log[first, 0], second=log[first, 1]),
            Covariate("t_s", self._t_s[middle]),
            Covariate("session_time_s", session_time_s(measurement)[middle]),
            trial_covariate(measurement, first),
            Covariate("wheel_angle_rad[left]", angle_rad[:, 1], CovariateShape.PERIODIC),
            Covariate("wheel_angle_rad[right]", angle_rad[:, 0], CovariateShape.PERIODIC),
        )
        # Where the floor is slippery, a share of each motion is lost. A tracked heading that is wrong by a function of
        # the heading changes turns by the derivative of this function, and turns the motion forward to the side.
        sizes = {"position": tuple(predicted.T), "theta_rad": (None, predicted[:, 0], predicted[:, 2])}
        sds, correlations, pose_noise = self._noise(measurement, nominal)
        # A place is seen from the body, which has turned until the later window begins.
        alike = (np.cos(predicted[:, 2]), np.cos(predicted[:, 2]), 1.0)
        turns = self._ticks / nominal.encoder.counts_per_revolution
        damages = lost_counts(turns, (first, last), nominal.drive.track_m) if self.has_wheels else ()
        errors = tuple(zip(*damages, strict=True)) or ((),) * len(COMPONENTS)
        holdout = held_out_rows(measurement)[first] | held_out_rows(measurement)[last]
        usable: Mask = self._complete & np.isfinite(values).all(axis=-1)
        if isinstance(measurement.nominal, KnownWheels):
            # The noise of a real camera. Simulated runs do not scatter, and then the guess stays.
            rows = usable & ~holdout
            noises = [window_noise(values[:, k] - predicted[:, k], trial, rows, SHARE_NO_POSE) for k in range(3)]
            sds = tuple(sd if noise is None else np.full(len(sd), noise) for sd, noise in zip(sds, noises, strict=True))
        return tuple(
            Observed(
                name=name,
                channel=self.channels[k],
                unit=unit,
                values=np.where(usable, values[:, k], np.nan),
                sd=sds[k],
                correlation=correlations[k],
                shared=SharedReading(WINDOW // STRIDE, -0.5 * pose_noise[k] * alike[k]),
                readings=READINGS[k],
                trial=trial,
                t_s=self._t_s[first],
                holdout=holdout,
                usable=usable,
                covariates=self._with_slip(
                    tuple(replace(c, size=sizes[c.name][k]) if c.name in sizes else c for c in covariates), nominal, k
                ),
                input_errors=errors[k],
                samples=f"windows of {WINDOW} rows, of which one begins at every {STRIDE}th row,",
            )
            for k, (name, unit) in enumerate(COMPONENTS)
        )

    def _with_slip(
        self, covariates: tuple[Covariate, ...], nominal: RobotConfig, component: int
    ) -> tuple[Covariate, ...]:
        """Return the covariates of a component with those by which wheels slip."""
        if not self.has_wheels:
            return covariates
        count_m = pi * nominal.drive.wheel_diameter_m / nominal.encoder.counts_per_revolution
        poses = np.stack([np.ravel(self._place.x_m), np.ravel(self._place.y_m), self._heading_rad], axis=-1)
        travel_m, windows = count_m * self._counted, (self._first, self._last)
        motion = CountedMotion(travel_m, self._steps_s, poses, self._starts, windows, nominal.drive.track_m, count_m)
        patches, further = slip_functions(motion, component)
        with_patches = (
            replace(c, functions=patches, functions_are=PATCH) if c.name == "position" else c for c in covariates
        )
        return (*with_patches, *further)

    def _noise(
        self, measurement: Measurement, nominal: RobotConfig
    ) -> tuple[tuple[Array, ...], tuple[float, ...], tuple[Array, ...]]:
        """Return the standard deviations (m,) of each component, the correlations of successive windows, and the shares
        (m,) of the variance that come from the noise of the two poses.
        """
        noise, travel_m = PoseNoise.from_measurement(measurement), np.cumsum(self.travel_m(nominal))
        q = noise.slip_m_per_sqrt_m**2 * (travel_m[self._last] - travel_m[self._first])
        by_log = self._added_variance(measurement)
        slip_place, slip_heading = 0.5 * q + by_log[0], 2.0 * q / nominal.drive.track_m**2 + by_log[1]
        place = 2.0 * noise.xy_m**2 + (LEVER_M * noise.theta_rad) ** 2 + slip_place
        heading = 2.0 * noise.theta_rad**2 + slip_heading
        # Half of the travel of a window, and so of its slip, belongs to the next window too.
        shared = (
            0.5 * float(slip_place.sum() / (place.sum() or 1.0)),
            0.5 * float(slip_heading.sum() / (heading.sum() or 1.0)),
        )
        sd = np.sqrt(place)
        place_noise, heading_noise = (
            np.divide(2.0 * pose_sd**2, whole, out=np.zeros(len(whole)), where=whole > 0.0)
            for pose_sd, whole in ((noise.xy_m, place), (noise.theta_rad, heading))
        )
        return (sd, sd, np.sqrt(heading)), (shared[0], shared[0], shared[1]), (place_noise, place_noise, heading_noise)


def _with_slots(robot: RobotConfig, slots: frozenset[Slot]) -> RobotConfig:
    """Return a robot with its effects in some slots alone."""
    effects = robot.effects.in_slots(slots)
    if len(effects) == len(tuple(robot.effects)):
        return robot
    return robot.model_copy(update={"effects": RobotEffects(effects)})


def seen_from_body(yaw_rad: Array, change: Array) -> Array:
    """Return changes of pose (..., 3) in W with their places in the frame of a body with this yaw (...)."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y, turn = change[..., 0], change[..., 1], change[..., 2]
    return np.stack(np.broadcast_arrays(c * x + s * y, c * y - s * x, turn), axis=-1)
