"""Voltages -> mean speeds of both wheels between rows, as counted by the encoders."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import exp, pi

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.importers.drive_log import ROW_S
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.zero_order_hold import held_means
from diagnosis.predictors.base import (
    Covariate,
    CovariateShape,
    InputResponse,
    Observed,
    Predicted,
    SharedFunctions,
)
from diagnosis.predictors.distinct import KnownPredictions
from diagnosis.predictors.grid import Grid
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
from diagnosis.predictors.wheels.as_commanded import as_commanded
from diagnosis.predictors.wheels.count_noise import CountNoise, continued
from diagnosis.predictors.wheels.early_voltages import PARTS as EARLY_PARTS
from diagnosis.predictors.wheels.early_voltages import (
    SHAPES,
    EarlyVoltages,
    held_earlier,
    independent_responses,
    shaped,
    steps_s,
)
from diagnosis.predictors.wheels.floor_loads import floor_loads
from diagnosis.predictors.wheels.row_lengths import row_lengths_s, sample_lengths_s
from diagnosis.predictors.wheels.turning_loads import TURNING, turning_loads
from physics.drivetrain.wheel_turns import NO_LOAD, MeasuredRows, WheelLoad, counted_turns
from physics.robot.model import RobotModel
from physics.robot.stack import MOTOR_TORQUE_SLOTS, stackable_groups, stacked
from symolo.core.arrays import Array

SIDES = ("left", "right")
PARTS = ("motor", "power", "encoder")
SLOTS = MOTOR_TORQUE_SLOTS | {
    Slot.MOTORS,
    Slot.COMMAND_DELAY,
    Slot.ACTUATOR,
    Slot.BATTERY,
    Slot.GEARBOX,
    Slot.ENCODER,
    Slot.COUNTING,
}
"""Slots of the effects between the voltages and the counts."""
UNSTATED_RAD_S = 0.05
"""Noise if it is not stated."""
PARTS_OF_ROW = (1, 2, 4, 8, 16)
"""Numbers of parts into which a row may be divided if its voltage changes within it; the last is taken as exact."""
MIN_INERTIA_KG_M2 = 1e-12
"""Smallest inertia; a motor without inertia follows its voltage at once."""
ERROR_SHARE = 0.1
"""Error by the division that does not matter, as a share of the noise."""
DEAD_ZONES = tuple(np.geomspace(0.01, 0.16, 25).tolist())
"""Widths of dead zones of the voltage that are tried, as shares of the supply's voltage."""
LOAD = 0.02
"""Voltage that the largest torque of a turning load takes, as a share of the supply's voltage."""


class Wheels:
    """One motor for each wheel, at rest at the start of each trial. Row k is about the time from row k to row k + 1."""

    name = "wheels"
    at_once = 96

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        is_case = isinstance(measurement.nominal, NominalDrive)
        self._grid = Grid.from_measurement(measurement, 1.0 / ROW_S if is_case else None)
        # The motor of a case includes the inertia and friction of the whole robot, that of a robot file does not.
        self._load = NO_LOAD if is_case else WheelLoad.from_model(RobotModel.from_config(nominal))
        self._is_coupled = not is_case
        self._counts = nominal.encoder.counts_per_revolution
        self._first, self._next = rows_after(measurement, 1)
        self._lasts_s = row_lengths_s(measurement, self._grid, self._first, self._next)
        self._row_s = sample_lengths_s(self._grid, self._first, self._lasts_s)
        self._parts, self._voltage_V = 1, self._voltages_V(measurement, 1)
        self._measured = self._measured_rows(measurement)
        speeds = list(self._speeds([nominal])[0])
        self._known = KnownPredictions(PARTS, SLOTS, self._speeds)
        set_speeds = _set_speeds(measurement, nominal)
        sd = measurement.nominal.noise.wheel_speed_rad_s if isinstance(measurement.nominal, NominalDrive) else None
        if any(trial.held_inputs for trial in measurement.trials):
            speeds = self._divided(measurement, nominal, ERROR_SHARE * (sd or UNSTATED_RAD_S))
        early = self._early_voltages(measurement, nominal)
        trial = trial_of_rows(measurement)
        commanded = [as_commanded(speed, each, trial) for speed, each in zip(speeds, set_speeds, strict=True)]
        dead_zones, loads = self._dead_zones(nominal), self._turning_loads(nominal, commanded)
        observed = (
            replace(
                self._observed(measurement, side, speed, set_speed, sd or UNSTATED_RAD_S),
                early=each,
                input_errors=(*zones, *turn_noise),
            )
            for side, speed, set_speed, each, zones, turn_noise in zip(
                SIDES, speeds, set_speeds, early, dead_zones, loads, strict=True
            )
        )
        turning = _turning(nominal, commanded)
        keep_shares = self._keep_shares(nominal)
        wheels = [
            replace(
                each,
                count_noise=self._count_noise(each, keep),
                covariates=(*each.covariates, replace(turning, size=np.sign(np.nan_to_num(speed)))),
            )
            for each, keep, speed in zip(observed, keep_shares, commanded, strict=True)
        ]
        floor = self._floor_loads(measurement, nominal, speeds, wheels)
        self.observed: tuple[Observed, ...] = tuple(
            replace(each, shared_functions=loads) for each, loads in zip(wheels, floor, strict=True)
        )

    def _measured_rows(self, measurement: Measurement) -> MeasuredRows:
        """Return the logged places and the counted angles; places between known ones lie on a line,
        and a trial without any is at 0.
        """
        t_s, trials = joined(trial.t_s for trial in measurement.trials), [len(each.t_s) for each in measurement.trials]
        place_m = bridged(np.stack([good_values(measurement, name) for name in ("x_m", "y_m")], axis=-1), t_s, trials)
        counts = np.stack([good_values(measurement, f"enc_{side}_ticks") for side in ("right", "left")], axis=-1)
        held_m = self._grid.held(place_m)
        return MeasuredRows(held_m[..., :1], held_m[..., 1:], self._grid.at_samples(2.0 * pi / self._counts * counts))

    def coupling_rad_s(self, robot: RobotConfig, share: float) -> Array | None:
        """Return the change of the speeds of the left and the right wheel (2, n) if the body couples the wheels.

        An acceleration of one wheel then takes torque at the other one, too. The motor of a case includes the inertia
        of the robot, but how much of it is mutual is not stated. None if it is known.

        Args:
            robot: The robot.
            share: Mutual inertia as a share of the inertia of a wheel.
        """
        if self._is_coupled:
            return None
        mutual_kg_m2 = share * float(RobotModel.from_config(robot).motors.left.inertia_kg_m2)
        coupled, bare = (
            self._speeds_by([robot], self._voltage_V, self._parts, load)[0]
            for load in (WheelLoad(mutual_kg_m2=mutual_kg_m2), NO_LOAD)
        )
        return coupled - bare

    def _keep_shares(self, nominal: RobotConfig) -> Iterator[float]:
        """Yield the share of its speed that each wheel keeps from row to row without a voltage."""
        motors = RobotModel.from_config(nominal).motors
        for motor in (motors.left, motors.right):
            inertia = float(motor.inertia_kg_m2 + self._load.inertia_kg_m2)
            yield exp(-self._grid.period_s * motor.damping_N_m_s_rad / max(inertia, MIN_INERTIA_KG_M2))

    def _count_noise(self, observed: Observed, keep: float) -> CountNoise:
        lasts_s = np.full(len(observed.values), self._grid.period_s)
        lasts_s[self._first] = self._lasts_s
        # The error of a rounded count is even, and there are two of them in each speed.
        rounding = 2.0 * pi / self._counts / lasts_s / np.sqrt(6.0)
        goes_on = continued(observed.trial, observed.holdout, lasts_s, self._grid.period_s)
        return CountNoise.from_rounding(rounding, goes_on, observed.usable, keep, float(np.median(observed.sd)))

    def _early_voltages(self, measurement: Measurement, nominal: RobotConfig) -> tuple[EarlyVoltages, ...]:
        """Return the responses of the left and the right wheel to voltages that act before they are logged."""
        held = [self._grid.zero_order_hold(measurement.trials, f"u_{side}_V") for side in ("right", "left")]
        samples_V, motors = np.stack(held, axis=-1), RobotModel.from_config(nominal).motors
        if any(trial.held_inputs for trial in measurement.trials):
            parts, steps_V = max(self._parts, EARLY_PARTS), self._steps_within_rows_V(measurement)
            by_shape = [self._voltages_V(_earlier(measurement, shape), parts) for shape in SHAPES]
        else:
            parts, steps_V = EARLY_PARTS, np.diff(samples_V, axis=0)
            by_shape = [shaped(samples_V, shape) for shape in SHAPES]
        early = []
        for index, (motor, wheel) in enumerate(((motors.left, 1), (motors.right, 0))):
            inertia = float(motor.inertia_kg_m2 + self._load.inertia_kg_m2)
            responses = independent_responses(motor, inertia, steps_V[..., wheel], self._grid.period_s)
            scatter = self._grid.of_rows(np.concatenate([responses, np.zeros_like(responses[:1])]))
            early.append(EarlyVoltages(partial(self._early_changes, by_shape, parts, index), scatter))
        return tuple(early)

    def _early_changes(self, by_shape: Sequence[Array], parts: int, index: int, robot: RobotConfig) -> Array:
        """Return the changes (2, n) of the speeds of a wheel by voltages that act early."""
        return np.nan_to_num(np.diff([self._speeds_by([robot], each, parts)[0, index] for each in by_shape], axis=0))

    def _dead_zones(self, nominal: RobotConfig) -> tuple[tuple[InputResponse, ...], ...]:
        """Return the responses of the left and the right wheel to bridges that ignore voltages below a threshold."""
        widths_V = nominal.power.battery_voltage_V * np.array(DEAD_ZONES)
        ignored = np.abs(self._voltage_V[:, None]) <= widths_V[:, None, None]
        what = "dead zone of the voltage"
        return tuple(
            tuple(InputResponse("u_V", what, change, chosen=1) for change in changes)
            for changes in self._changes(nominal, np.where(ignored, 0.0, self._voltage_V[:, None]))
        )

    def _turning_loads(self, nominal: RobotConfig, speeds: Sequence[Array]) -> tuple[tuple[InputResponse, ...], ...]:
        """Return the responses of the left and the right wheel to loads that come with turning at given speeds."""
        left, right = speeds
        loads = tuple(turning_loads(self._grid.held(np.stack([right, left], axis=-1))[:-1]))
        if not loads:
            return ((), ())
        load_V = LOAD * nominal.power.battery_voltage_V * np.stack([torque for _, torque in loads], axis=1)
        loaded_V = self._voltage_V[:, None] + np.repeat(load_V, self._parts, axis=0)
        return tuple(
            tuple(InputResponse(TURNING, what, change) for (what, _), change in zip(loads, changes, strict=True))
            for changes in self._changes(nominal, loaded_V)
        )

    def _floor_loads(
        self, measurement: Measurement, nominal: RobotConfig, speeds: Sequence[Array], wheels: Sequence[Observed]
    ) -> tuple[tuple[SharedFunctions, ...], ...]:
        """Return the responses of the left and the right wheel to friction that depends on the place."""
        poses = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
        goes_on = np.zeros(len(poses), dtype=bool)
        goes_on[self._first] = True
        signs = [np.sign(np.nan_to_num(speed)) for speed in speeds]
        noises = [each.count_noise for each in wheels if each.count_noise is not None]
        loads = tuple(floor_loads(poses, nominal.drive.track_m, signs, noises, goes_on))
        return tuple(zip(*loads, strict=True)) if loads else ((), ())

    def _changes(self, nominal: RobotConfig, voltages_V: Array) -> Array:
        """Return the changes (2, M, n) of the speeds of the left and the right wheel by voltages (T parts, M, N, 2)."""
        several_V = np.concatenate([self._voltage_V[:, None], voltages_V], axis=1)
        model = RobotModel.from_config(stacked([nominal], axes=2))
        begins_s = np.tile(self._grid.begins_s, several_V.shape[1])
        side_by_side = several_V.reshape(len(several_V), -1, len(SIDES))
        row_s = self._row_s
        row_s = np.tile(row_s, (1, several_V.shape[1])) if isinstance(row_s, np.ndarray) else row_s
        turned = counted_turns(model, side_by_side, row_s, begins_s, self._load, self._parts)
        speeds = self._mean_speeds(turned.reshape(len(turned), *several_V.shape[1:]))
        return np.moveaxis(np.nan_to_num(speeds[1:] - speeds[0]), 1, 0)

    def _steps_within_rows_V(self, measurement: Measurement) -> Array:
        """Return the changes (T, N, 2) of the voltages within rows, as far as they may act early in the row's mean."""
        squares = np.zeros((self._grid.samples - 1, len(measurement.trials), len(SIDES)))
        for k, trial in enumerate(measurement.trials):
            for series in trial.held_inputs:
                wheel = ("u_right_V", "u_left_V").index(series.name)
                row = ((series.t_s[1:] - 0.5 * steps_s(series)) / self._grid.period_s).astype(int)
                steps_V = np.diff(series.values) * steps_s(series) / self._grid.period_s
                inside = row < len(squares)
                np.add.at(squares[:, k, wheel], row[inside], steps_V[inside] ** 2)
        return np.sqrt(squares)

    def _divided(self, measurement: Measurement, nominal: RobotConfig, max_rad_s: float) -> list[Array]:
        """Divide rows into as many parts as the voltages within them need, and return the speeds of the nominal robot.

        A mean voltage is not enough: the speed at the end of a row depends more on its last voltages, and a motor that
        is stuck, or limited, does not see a mean.

        Args:
            measurement: The log.
            nominal: The nominal robot.
            max_rad_s: Root mean square error of the speeds that does not matter.
        """
        by_parts = {}
        for parts in PARTS_OF_ROW:
            self._parts, self._voltage_V = parts, self._voltages_V(measurement, parts)
            by_parts[parts] = self._speeds([nominal])[0]
        finest = by_parts[PARTS_OF_ROW[-1]]
        errors = {parts: np.sqrt(np.nanmean((speeds - finest) ** 2)) for parts, speeds in by_parts.items()}
        enough = next(parts for parts, error in errors.items() if error <= max_rad_s)
        self._parts, self._voltage_V = enough, self._voltages_V(measurement, enough)
        return list(by_parts[enough])

    def _voltages_V(self, measurement: Measurement, parts: int) -> Array:
        """Return the mean voltages of right and left wheel over each part of a row, (T parts, N, 2)."""
        return np.stack([self._held_V(measurement, f"u_{side}_V", parts) for side in ("right", "left")], axis=-1)

    def _held_V(self, measurement: Measurement, name: str, parts: int) -> Array:
        rows = np.repeat(self._grid.zero_order_hold(measurement.trials, name)[:-1], parts, axis=0)
        lasts_s = np.repeat(np.broadcast_to(self._row_s, rows[::parts].shape) / parts, parts, axis=0)
        begins_s = np.cumsum(lasts_s, axis=0) - lasts_s
        for k, (trial, place) in enumerate(zip(measurement.trials, self._grid.places, strict=True)):
            for series in trial.held_inputs:
                if series.name == name:
                    # Both begin at sample 0. A trial that ends before others has no voltage after its end.
                    inside = slice(parts * (int(place[-1]) + 1))
                    rows[inside, k] = held_means(series.t_s, series.values, begins_s[inside, k], lasts_s[inside, k])
        return rows

    def _observed(self, measurement: Measurement, side: str, predicted: Array, set_speed: Array, sd: float) -> Observed:
        voltage_V = good_values(measurement, f"u_{side}_V")
        angle_rad = 2.0 * pi / self._counts * good_values(measurement, f"enc_{side}_ticks")
        speed = np.full(len(predicted), np.nan)
        speed[self._first] = (angle_rad[self._next] - angle_rad[self._first]) / self._lasts_s
        split = held_out_rows(measurement)
        holdout = split.copy()
        # A mean speed is computed from two rows, and held out if one of them is.
        holdout[self._first] = split[self._first] | split[self._next]
        usable = np.isfinite(speed) & np.isfinite(voltage_V)
        trial = trial_of_rows(measurement)
        covariates = (
            Covariate("omega_rad_s", as_commanded(predicted, set_speed, trial)),
            Covariate("u_V", as_commanded(voltage_V, set_speed, trial)),
            Covariate("wheel_angle_rad", angle_rad, CovariateShape.PERIODIC),
            Covariate("t_s", joined(trial.t_s for trial in measurement.trials)),
            Covariate("session_time_s", session_time_s(measurement)),
            trial_covariate(measurement),
            Covariate("theta_rad", good_values(measurement, "theta_rad"), CovariateShape.PERIODIC),
            Covariate(
                "position",
                good_values(measurement, "x_m"),
                second=good_values(measurement, "y_m"),
                # The floor may brake the wheel, which turns either way.
                size=np.sign(np.nan_to_num(predicted)),
            ),
        )
        return Observed(
            name=f"wheel_{side}_rad_s",
            channel="wheel_speed_rad_s",
            unit="rad/s",
            values=np.where(usable, speed, np.nan),
            sd=np.full(len(speed), sd),
            # Rounded ticks make it negative from row to row, torque disturbances positive over some rows.
            correlation=None,
            trial=trial,
            t_s=joined(trial.t_s for trial in measurement.trials),
            holdout=holdout,
            usable=usable,
            covariates=tuple(covariate for covariate in covariates if np.isfinite(covariate.values).any()),
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        speeds = self._known.predictions(robots)
        return tuple(Predicted(speeds[:, k], observed.sd) for k, observed in enumerate(self.observed))

    def _speeds(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the speeds of the left and the right wheel, (M, 2, n); NaN in the last row of a trial."""
        return self._speeds_by(robots, self._voltage_V, self._parts)

    def _speeds_by(
        self, robots: Sequence[RobotConfig], voltage_V: Array, parts: int, load: WheelLoad | None = None
    ) -> Array:
        """Return the same with voltages (T parts, N, 2) that are constant in each part of a row."""
        speeds = np.empty((len(robots), len(SIDES), sum(len(place) for place in self._grid.places)))
        for group in stackable_groups(robots):
            model = RobotModel.from_config(stacked([robots[k] for k in group], axes=2, lengths=voltage_V.shape[1:]))
            turned = counted_turns(
                model, voltage_V, self._row_s, self._grid.begins_s, load or self._load, parts, self._measured
            )
            # Measured speeds were computed from ticks with the nominal number of ticks per turn.
            scale = np.asarray(model.counts_per_revolution / self._counts)
            turned = (turned[:, None] if scale.ndim > turned.ndim - 1 else turned) * scale
            speeds[group] = self._mean_speeds(turned)
        return speeds

    def _mean_speeds(self, turned_rad: Array) -> Array:
        """Return the mean speeds of the left and the right wheel (..., 2, n) from the turns (T, ..., N, 2) in rows."""
        counted = np.concatenate([np.zeros_like(turned_rad[:1]), np.cumsum(turned_rad, axis=0)])
        angle = np.stack([self._grid.of_rows(counted[..., wheel]) for wheel in (1, 0)], axis=-2)
        speeds = np.full(angle.shape, np.nan)
        speeds[..., self._first] = (angle[..., self._next] - angle[..., self._first]) / self._lasts_s
        return speeds


def _earlier(measurement: Measurement, shape: Array) -> Measurement:
    """Return a measurement whose voltages change earlier than logged."""
    trials = (
        replace(trial, held_inputs=tuple(held_earlier(series, shape) for series in trial.held_inputs))
        for trial in measurement.trials
    )
    return replace(measurement, trials=tuple(trials))


def _turning(nominal: RobotConfig, speeds: Sequence[Array]) -> Covariate:
    """Return the rate of turning by the speeds of the left and the right wheel."""
    left, right = speeds
    rate_rad_s = 0.5 * nominal.drive.wheel_diameter_m * (right - left) / nominal.drive.track_m
    return Covariate(TURNING, rate_rad_s, max_waves=0.0)


def _set_speeds(measurement: Measurement, nominal: RobotConfig) -> tuple[Array, Array]:
    """Return the commanded speeds of the left and the right wheel, (n,) each [rad/s]; NaN where not logged."""
    forward_m_s, turn_rad_s = (good_values(measurement, name) for name in ("v_cmd_m_s", "w_cmd_rad_s"))
    apart_m_s, radius_m = 0.5 * nominal.drive.track_m * turn_rad_s, 0.5 * nominal.drive.wheel_diameter_m
    return (forward_m_s - apart_m_s) / radius_m, (forward_m_s + apart_m_s) / radius_m
