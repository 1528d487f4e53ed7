"""Cases of kind drive_log: a differential robot drives in an empty room, 20 Hz."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from benchmarks.diagnosis.independent_cases import disturbances
from benchmarks.diagnosis.independent_cases.disturbances import Plan
from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.drives import effects as drive_effects
from benchmarks.diagnosis.independent_cases.drives import outside as drive_outside
from benchmarks.diagnosis.independent_cases.drives import stages as drive_stages
from benchmarks.diagnosis.independent_cases.drives.paths import STYLES, commands
from benchmarks.diagnosis.independent_cases.drives.robot import SENSORS, Robot, draw_robot
from benchmarks.diagnosis.independent_cases.drives.sensors import logged_pose, ranges
from benchmarks.diagnosis.independent_cases.drives.simulation import Run, simulate
from benchmarks.diagnosis.independent_cases.drives.wheels import ROW_S, SIDES, SUB
from benchmarks.diagnosis.independent_cases.motors.motor import draw_individual
from benchmarks.diagnosis.independent_cases.motors.motor_effects import motor_recipe
from benchmarks.diagnosis.independent_cases.ranges.errors import noise_sd, wander_covariance
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import NO_TARGET_M
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Mask, Recipe, Variant
from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Setting, Table

POSE = ("x_m", "y_m", "theta_rad")
RANGES = tuple(f"tof_{sensor}_m" for sensor in SENSORS)
CHANNELS = ["wheel_speed", *POSE, *RANGES]
PAUSE_S = 5.0  # between trials
SECOND_SESSION_S = 3600.0


def _draw_plan(rng: np.random.Generator) -> Plan:
    """Draw the disturbances; x and y, and all ranges, have one noise factor each."""
    plan = disturbances.draw_plan(rng, CHANNELS)
    plan.noise_factor["y_m"] = plan.noise_factor["x_m"]
    for channel in RANGES:
        plan.noise_factor[channel] = plan.noise_factor[RANGES[0]]
    plan.outlier_share["wheel_speed"] = 0.0
    plan.lag1 = 0.0
    return plan


@dataclass(frozen=True)
class _WheelNoise:
    """Noise of the mean wheel speed."""

    stated_rad_s: float
    true_rad_s: float
    torque_sd_N_m: float
    lag1: float

    @classmethod
    def draw(cls, rng: np.random.Generator, robot: Robot, plan: Plan) -> Self:
        """Draw the noise, which is tick rounding and a small random torque that is new in every row.

        The noise factor acts on the torque. The motor filters the torque with its mechanical time constant; variance
        and covariance of the mean speed follow from the first-order response to a torque that is held for a row.
        """
        resistance, constant, viscous, inertia = (robot.motor.value(key) for key in ("R", "K", "B", "J"))
        rounding = 2 * np.pi / robot.ticks / ROW_S / np.sqrt(6)
        stated = significant(np.hypot(rounding, robot.wheel_speed_rad_s * log_uniform(rng, 0.002, 0.006)), 2)
        true = max(stated * plan.noise_factor["wheel_speed"], 1.02 * rounding)
        plan.noise_factor["wheel_speed"] = round(true / stated, 3)
        wander = np.sqrt(true**2 - rounding**2)
        gain = resistance / (constant**2 + viscous * resistance)
        x = ROW_S / (inertia * gain)
        keep, share = np.exp(-x), -np.expm1(-x) / x
        at_rows = (1 - keep) / (1 + keep)
        variance = share**2 * at_rows + (1 - share) ** 2
        covariance = share * (keep * share * at_rows + (1 - keep) * (1 - share))
        lag = (covariance / variance * wander**2 - 0.5 * rounding**2) / true**2
        return cls(stated, true, wander / np.sqrt(variance) / gain, float(np.clip(lag, -0.5, 0.9)))


def _draw_stated_noise(rng: np.random.Generator, robot: Robot, plan: Plan, wheel: _WheelNoise) -> dict[str, float]:
    """Draw the stated noise; that of the pose hides tick rounding, which the pose sigmas of the format leave out."""
    stated = {
        "wheel_speed_rad_s": wheel.stated_rad_s,
        "pose_xy_m": significant(log_uniform(rng, 4e-4, 3e-3), 2),
        "pose_theta_rad": significant(log_uniform(rng, 1e-3, 8e-3), 2),
        "travel_m_per_sqrt_m": significant(log_uniform(rng, 2e-4, 1.2e-3), 2),
    }
    rounding = 2 * np.pi * robot.radius_m / robot.ticks / np.sqrt(6)
    min_stated = {"pose_xy_m": rounding / np.sqrt(2) / 0.3, "pose_theta_rad": rounding / robot.track_m / 0.3}
    for key, channel in (("pose_xy_m", "x_m"), ("pose_theta_rad", "theta_rad")):
        stated[key] = max(stated[key], significant(min_stated[key] / plan.noise_factor[channel], 2))
    return stated


class DriveSetting(Setting):
    """A robot with its drives."""

    KIND = "drive_log"
    PLACE = drive_effects.PLACE
    OUTSIDE = list(drive_outside.RECIPES)
    IN_NOISE = ("range_wander",)

    def __init__(self, rng: np.random.Generator) -> None:
        """Draw robot, room, manoeuvres, individual and noise."""
        self.robot, self.plan = draw_robot(rng), _draw_plan(rng)
        self.tolerance_factor = disturbances.draw_tolerance_factor(rng)
        self.trials, seconds = pick(rng, [(2, 30), (3, 30), (4, 30), (4, 40), (4, 60), (6, 20), (6, 30)])
        self.fit_trials, every = self.trials - max(1, self.trials // 4), self.trials + 1  # the last one is unseen
        rows = int(seconds / ROW_S) + 1
        self.session_s = (np.arange(every) * (seconds + PAUSE_S))[:, None] + np.arange(rows)[None, :] * ROW_S
        self.styles = [pick(rng, list(STYLES)) for _ in range(every)]
        middle = np.tile(np.array(self.robot.room) / 2, (every, 1))
        self.start = np.concatenate([middle, rng.uniform(-np.pi, np.pi, (every, 1))], axis=1)  # m, m, rad
        self.wheel = _WheelNoise.draw(rng, self.robot, self.plan)
        self.stated = _draw_stated_noise(rng, self.robot, self.plan, self.wheel)
        self.individual = draw_individual(rng, self.robot.all_nominal, self.tolerance_factor)
        self.voltages_logged = bool(rng.random() < 0.8)
        self.no_target_share = round(rng.uniform(0, 0.03), 4) if rng.random() < 0.4 else 0.0
        self.loop_seed = int(rng.integers(2**31))
        # Rows that the robot drives back to the middle of the room.
        self.away_rows = int(np.ceil(0.3 * min(self.robot.room) / (0.6 * self.robot.top_speed_m_s) / ROW_S))
        self.script = np.stack([commands(rng, rows, style, self.robot) for style in self.styles])
        self.second_session: int | None = None  # first trial of a second session, an hour later
        self.runs: list[tuple[Variant, Run]] = []  # those that were simulated already

    @property
    def xy_sd_m(self) -> float:
        """True noise of the tracked position."""
        return self.stated["pose_xy_m"] * self.plan.noise_factor["x_m"]

    @property
    def theta_sd_rad(self) -> float:
        """True noise of the tracked heading."""
        return self.stated["pose_theta_rad"] * self.plan.noise_factor["theta_rad"]

    @property
    def travel_noise(self) -> float:
        """Noise of the travel of a wheel [m per square root of m]."""
        return self.stated["travel_m_per_sqrt_m"]

    @property
    def range_factor(self) -> float:
        """True noise of the ranges over the stated one."""
        return self.plan.noise_factor[RANGES[0]]

    def run_of(self, variant: Variant) -> Run:
        """Return the true run of a robot; it is simulated once."""
        for known, run in self.runs:
            if known == variant:
                return run
        self.runs.append((variant, simulate(self, variant)))
        return self.runs[-1][1]

    def prepare(self, names: Sequence[str], rng: np.random.Generator) -> bool:
        """Log voltages for effects of the motor; a turned marker may come in two sessions with an angle each."""
        if any(name in drive_effects.MOTOR_NAMES or name in drive_outside.WHEELS for name in names):
            self.voltages_logged = True
        if "marker_yaw" in names and rng.random() < 0.5:
            self.second_session = max(1, self.fit_trials // 2)
            self.session_s[self.second_session :] += SECOND_SESSION_S
        return True

    def plausible(self, variant: Variant) -> bool:
        """Return whether the robot stays in the room."""
        position = self.run_of(variant).poses[..., :2]
        margin = 0.5 * self.robot.track_m
        return bool(np.all(position > margin) and np.all(position < np.array(self.robot.room) - margin))

    @property
    def tolerance_names(self) -> list[str]:
        """Names of the nominal parameters with a tolerance; those of the motor show in logged voltages."""
        return list(self.robot.all_nominal if self.voltages_logged else self.robot.nominal)

    @property
    def rival_names(self) -> list[str]:
        """Listed names that act on the mean of some channel; those of the motor show in logged voltages."""
        return [n for n in super().rival_names if self.voltages_logged or n not in drive_effects.MOTOR_NAMES]

    def recipe(self, name: str, rng: np.random.Generator) -> Recipe:
        robot, span = self.robot, float(self.session_s[-2, -1])
        if name in drive_effects.MOTOR_NAMES:
            top, speed = robot.motor.supply_V * 0.6, robot.wheel_speed_rad_s
            use = {"top_voltage_V": top, "duration_s": span, "top_speed_rad_s": speed}
            recipe = motor_recipe(name, rng, robot.motor, **use, motors=2)
            # Rows of 50 ms need longer delays than samples of 5 ms.
            return Recipe(name, recipe.place, 2e-3, 0.15, recipe.parameters) if name == "input_delay" else recipe
        direction = draw_sign(rng)
        if name in drive_outside.RECIPES:
            when, phase = float(rng.uniform(0.25, 0.55) * span), rng.uniform(-np.pi, np.pi)
            disc = drive_outside.draw_disc(rng, robot)
            outside = drive_outside.OutsideDraft(name, "outside", rng, direction, robot, span, when, phase, disc)
            return drive_outside.RECIPES[name](outside)
        sensor, wheel, phase = pick(rng, SENSORS), pick(rng, SIDES), rng.uniform(-np.pi, np.pi)
        place, recipe = drive_effects.RECIPES[name]
        second, trials = self.second_session, self.trials + 1
        return recipe(
            drive_effects.DriveDraft(name, place, rng, direction, sensor, wheel, phase, robot, second, trials)
        )

    def noise_ratio(self, effect: Effect, others: Sequence[Effect]) -> float:
        """Take the mean over blocks of rows of a sensor."""
        del others
        pose = self.run_of(Variant()).poses[: self.fit_trials, ::SUB]
        _, usable = drive_stages.usable_ranges(self, pose)
        sd = drive_stages.range_sigma(self, pose)
        t = np.arange(drive_stages.BLOCK) * ROW_S
        covariance = wander_covariance(t, effect.parameters["sd_m"], effect.parameters["time_constant_s"])
        level = np.median(sd[usable]) if usable.any() else 1.0
        extra = np.clip(np.linalg.eigvalsh(covariance / level**2), 0, None)
        return float(np.sum(extra - np.log1p(extra)) * usable.sum() / drive_stages.BLOCK)

    def signatures(self, variants: Sequence[Variant], noise_effects: Sequence[Effect]) -> Array:
        return drive_stages.stage_signatures(self, self.run_of(Variant()), variants, noise_effects)

    def produce(self, variant: Variant, rng: np.random.Generator) -> CaseFiles:
        run, everyone = self.run_of(variant), list(range(self.trials + 1))
        pose = logged_pose(variant, run.poses, everyone)
        noisy = pose + self._pose_sd * rng.standard_normal(pose.shape)
        clean, beyond = self._wandering_ranges(variant, run, rng)
        sd = noise_sd(clean, self.robot.polynomial_mm, self.robot.origin_m) * self.range_factor
        reading = clean + sd * rng.standard_normal(clean.shape)
        masks = disturbances.outlier_masks(rng, self.trials * pose.shape[1], CHANNELS, self.plan)
        columns = self._logged_columns(run)
        for i, channel in enumerate(RANGES):
            columns[channel] = self._range_column(reading[..., i], sd[..., i], beyond[..., i], masks[channel], rng)
        lost = disturbances.dropouts(rng, len(masks["x_m"]), self.plan.dropout_share)
        for i, channel in enumerate(POSE):
            spikes = disturbances.spikes(rng, np.full(len(lost), self._pose_sd[i]))
            values = noisy[: self.trials, :, i].ravel() + np.where(masks[channel], spikes, 0.0)
            columns[channel] = (np.where(lost, np.nan, values), "%.4f")
        noise = {
            **self.stated,
            "tof_polynomial_mm": self.robot.polynomial_mm,
            "tof_polynomial_origin_m": self.robot.origin_m,
        }
        nominal = {"kind": self.KIND, **self.robot.sections(), "noise": noise}
        tables = {"data.csv": columns, **self._blind_tables(run, noisy[-1], pose[-1])}
        return CaseFiles(nominal, tables)

    @property
    def _pose_sd(self) -> Array:
        """True noise of the tracked pose (m, m, rad)."""
        return np.array([self.xy_sd_m, self.xy_sd_m, self.theta_sd_rad])

    def _wandering_ranges(self, variant: Variant, run: Run, rng: np.random.Generator) -> tuple[Array, Mask]:
        """Return ranges (m) with a slow error but no noise, and whether they are beyond reach."""
        clean, beyond = ranges(self, variant, run.poses, list(range(self.trials + 1)))
        wander = dict(variant.effects).get("range_wander")
        if wander is not None:
            keep = np.exp(-ROW_S / wander["time_constant_s"])
            path = disturbances.correlated_noise(rng, (3, *clean.shape[:2]), keep)
            clean = clean + wander["sd_m"] * path.transpose(1, 2, 0)
        return clean, beyond

    def _logged_columns(self, run: Run) -> Table:
        """Return the columns of trials, times, commands, voltages and encoders."""
        n, rows = self.trials, run.counts.shape[1]
        volts = np.concatenate([run.u_V, np.full((n + 1, 1, 2), np.nan)], axis=1)
        if not self.voltages_logged:
            volts = np.full_like(volts, np.nan)
        split = ["fit"] * self.fit_trials + ["holdout"] * (n - self.fit_trials)
        columns: Table = {
            "trial": (np.repeat(np.arange(1, n + 1), rows), "%d"),
            "split": (np.repeat(split, rows), "%s"),
            "session_time_s": (self.session_s[:n].ravel(), "%.2f"),
            "t_s": (np.tile(np.arange(rows) * ROW_S, n), "%.2f"),
        }
        for name, values, form in (
            (("v_cmd_m_s", "w_cmd_rad_s"), run.commands, "%.3f"),
            (("u_left_V", "u_right_V"), volts, "%.3f"),
            (("enc_left_ticks", "enc_right_ticks"), run.counts, "%d"),
        ):
            columns |= {name[i]: (values[:n, :, i].ravel(), form) for i in (0, 1)}
        return columns

    def _range_column(
        self, reading: Array, sd: Array, beyond: Mask, mask: Mask, rng: np.random.Generator
    ) -> tuple[Array, str]:
        """Return the readings (m) of one sensor with outliers, readings without a target and empty cells."""
        n = self.trials
        spikes = disturbances.spikes(rng, sd[:n].ravel())
        values = np.maximum(np.round(reading[:n].ravel() + np.where(mask, spikes, 0.0), 3), 0.0)
        values = np.where(rng.random(len(mask)) < self.no_target_share, NO_TARGET_M, values)
        gone = beyond[:n].ravel() | disturbances.dropouts(rng, len(mask), self.plan.dropout_share)
        return np.where(gone, np.nan, values), "%.3f"

    def _blind_tables(self, run: Run, noisy: Array, pose: Array) -> dict[str, Table]:
        """Return the inputs of the unseen trial: voltages for wheels, ticks for pose, poses for ranges."""
        rows = len(pose)
        times: Table = {"session_time_s": (self.session_s[-1], "%.2f"), "t_s": (np.arange(rows) * ROW_S, "%.2f")}
        ticks: Table = {f"enc_{side}_ticks": (run.counts[-1, :, i], "%d") for i, side in enumerate(SIDES)}
        first: Table = {c: (np.where(np.arange(rows) == 0, noisy[0, i], np.nan), "%.4f") for i, c in enumerate(POSE)}
        poses: Table = {c: (pose[:, i], "%.5f") for i, c in enumerate(POSE)}
        tables = {"blind_pose_inputs.csv": {**times, **ticks, **first}, "blind_tof_inputs.csv": {**times, **poses}}
        if self.voltages_logged:
            short: Table = {key: (values[:-1], form) for key, (values, form) in times.items()}
            volts: Table = {f"u_{side}_V": (run.u_V[-1, :, i], "%.3f") for i, side in enumerate(SIDES)}
            tables["blind_wheels_inputs.csv"] = {**short, **volts}
        return tables

    def describe(self) -> dict[str, Any]:
        return {
            "layout": self.styles[: self.trials],
            "rows": self.trials * self.session_s.shape[1],
            "voltages_logged": self.voltages_logged,
            "second_session_from_trial": self.second_session,
            "no_target_share": self.no_target_share,
            "room_m": self.robot.room,
        }
