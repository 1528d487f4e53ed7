"""Cases of kind motor_step: trials of 200 Hz with steps, squares, chirps and random voltages."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases import disturbances
from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.motors import motor_effects, step_outside
from benchmarks.diagnosis.independent_cases.motors.excitation import draw_styles, waveform
from benchmarks.diagnosis.independent_cases.motors.motor import draw_individual, draw_motor
from benchmarks.diagnosis.independent_cases.motors.motor_effects import apply_motor, motor_recipe
from benchmarks.diagnosis.independent_cases.motors.motor_law import plain_law
from benchmarks.diagnosis.independent_cases.motors.motor_steady import read_by_sensors
from benchmarks.diagnosis.independent_cases.motors.step_integrator import DT_S, Lane, filtered, run, sampled
from benchmarks.diagnosis.independent_cases.motors.two_bodies import Joint, Play, Spring
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Parameters, Recipe, Variant
from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Setting, Table

CHANNELS = ["current_A", "omega_rad_s"]
STEPS, FINE_STEPS = 5, 20
JOINTS = {"gear_backlash": "play", "two_mass_ringing": "spring"}


def _resolution(sd: float) -> float:
    """Return a resolution of 1, 2 or 5 times a power of ten, about a fifth of the noise, in its unit."""
    power = 10 ** np.floor(np.log10(sd / 5))
    return float(power * max(m for m in (1, 2, 5) if m * power <= sd / 5 * 1.0001))


def _joint_of(variant: Variant) -> tuple[str, Parameters]:
    """Return what connects motor and load (`rigid`, `play` or `spring`) and its parameters."""
    for effect in (*variant.effects, *variant.outside):
        if effect.name in JOINTS:
            return JOINTS[effect.name], effect.parameters
    return "rigid", {}


class StepSetting(Setting):
    """Bench of step trials."""

    KIND = "motor_step"
    PLACE = motor_effects.places_of("step")
    OUTSIDE = list(step_outside.RECIPES)
    FURTHER = list(step_outside.FURTHER)
    tolerance_names = ["R", "K", "B", "Tc", "J"]

    def __init__(self, rng: np.random.Generator) -> None:
        """Draw motor, voltages, individual and noise."""
        self.motor = draw_motor(rng)
        self.tolerance_factor = disturbances.draw_tolerance_factor(rng)
        self.trials, self.samples = int(pick(rng, [3, 4, 6, 6, 8])), int(pick(rng, [300, 500, 500, 600]))
        self.fit_trials = self.trials - max(1, self.trials // 3)
        self.top_voltage_V = self.motor.supply_V * rng.uniform(0.5, 1.0)
        self.top_speed_rad_s = self.top_voltage_V / self.motor.value("K")
        self.styles = draw_styles(rng, self.trials + 2)
        stall = self.top_voltage_V / self.motor.value("R")
        self.stated = {
            "current_A": significant(stall * log_uniform(rng, 0.003, 0.02), 2),
            "omega_rad_s": significant(self.top_speed_rad_s * log_uniform(rng, 0.003, 0.015), 2),
            "lag1_correlation": float(pick(rng, [0.0, 0.2, 0.3, 0.3, 0.4, 0.5])),
        }
        self.plan = disturbances.draw_plan(rng, CHANNELS)
        self.plan.lag1 = self.stated["lag1_correlation"]
        self.individual = draw_individual(rng, self.motor.nominal, self.tolerance_factor)
        # (trials + 2, samples), the last two for the unseen trials
        self.u_V = np.stack([waveform(rng, self.samples, self.top_voltage_V, style) for style in self.styles])
        self.inertia_share = round(rng.uniform(0.4, 0.8), 2)  # on the motor side
        self.friction_share = round(rng.uniform(0.3, 0.7), 2)

    @property
    def rival_names(self) -> list[str]:
        """All listed names but gear_backlash, which takes four times as long and resembles only the ringing."""
        return [name for name in self.PLACE if name != "gear_backlash"]

    def recipe(self, name: str, rng: np.random.Generator) -> Recipe:
        top, speed, span = self.top_voltage_V, self.top_speed_rad_s, self.trials * self.samples * DT_S
        if name in self.PLACE:
            use = {"top_voltage_V": top, "duration_s": span, "top_speed_rad_s": speed}
            return motor_recipe(name, rng, self.motor, **use)
        direction, when, phase = draw_sign(rng), float(rng.uniform(0.2, 0.5) * span), rng.uniform(-np.pi, np.pi)
        tc = self.motor.value("Tc")
        idle = (tc + self.motor.value("B") * speed) / self.motor.value("K")
        numbers = (when, span, tc, speed, phase, top, idle, self.stated)
        draft = step_outside.StepDraft(name, "outside", rng, direction, *numbers)
        return (step_outside.RECIPES | step_outside.FURTHER)[name](draft)

    def _session_s(self, trial: int) -> Array:
        """Return the session times (s) of the samples of one trial."""
        return (trial * self.samples + np.arange(1, self.samples + 1)) * DT_S

    def _lane(self, variant: Variant, trial: int) -> Lane:
        """Return one trial of one variant."""
        law = plain_law(variant.individual(self.individual, self.motor.nominal), self.motor.supply_V)
        u = self.u_V[trial]
        for effect in variant.effects:
            apply_motor(law, effect)
        for effect in variant.outside:
            step_outside.change_law(law, effect, self._session_s(trial), trial, self.u_V)
            u = step_outside.change_command(u, effect, self._session_s(trial))
        listed = dict(variant.effects)
        delay = listed.get("input_delay", {"delay_s": 0.0})["delay_s"]
        lag = listed.get("actuator_lag", {"time_constant_s": 0.0})["time_constant_s"]
        return Lane(law, u, delay, lag)

    def _readings(self, variant: Variant, trial: int, history: Array, amps: Array, steps: int) -> tuple[Array, Array]:
        """Return the clean readings (A, rad/s) of one lane after the effects of the sensors."""
        listed = dict(variant.effects)
        if "speed_filter_lag" in listed:
            history = filtered(history, steps, listed["speed_filter_lag"]["time_constant_s"])
        speed = sampled(history, steps, listed.get("speed_time_offset", {"delay_s": 0.0})["delay_s"])
        angle = np.cumsum(0.5 * (history[1:] + history[:-1])) * DT_S / steps
        for effect in variant.outside:
            amps, speed = step_outside.change_reading(
                amps, speed, effect, angle[steps - 1 :: steps], self._session_s(trial)
            )
        return read_by_sensors(amps, speed, variant)

    def _joint(self, group: str, chosen: list[Parameters], lanes: list[Lane]) -> Joint | None:
        """Return what connects the sides of the gear in all lanes of one group."""
        if group == "rigid":
            return None
        if group == "play":
            return Play([p["gap_rad"] for p in chosen], self.inertia_share, self.friction_share)
        frequency, damping = (np.array([p[key] for p in chosen], float) for key in ("frequency_Hz", "damping_ratio"))
        inertia = np.array([lane.law.J for lane in lanes])
        return Spring(frequency, damping, inertia, self.inertia_share, self.friction_share)

    def predict(self, variants: Sequence[Variant], trials: Sequence[int]) -> tuple[Array, Array]:
        """Return clean readings: currents (A) and speeds (rad/s), each (variants, trials, samples)."""
        amps = np.empty((len(variants), len(trials), self.samples))
        speed = np.empty_like(amps)
        for group in ("rigid", "play", "spring"):
            members = [i for i, variant in enumerate(variants) if _joint_of(variant)[0] == group]
            if not members:
                continue
            keys = [(i, j, trial) for i in members for j, trial in enumerate(trials)]
            lanes = [self._lane(variants[i], trial) for i, _, trial in keys]
            steps = STEPS if group == "rigid" else FINE_STEPS
            joint = self._joint(group, [_joint_of(variants[i])[1] for i, _, _ in keys], lanes)
            history, current = run(lanes, steps, joint)
            for row, (i, j, trial) in enumerate(keys):
                amps[i, j], speed[i, j] = self._readings(variants[i], trial, history[row], current[row], steps)
        return amps, speed

    @property
    def _sd(self) -> dict[str, float]:
        """True noise of current (A) and speed (rad/s)."""
        return {c: self.stated[c] * self.plan.noise_factor[c] for c in CHANNELS}

    def signatures(self, variants: Sequence[Variant], noise_effects: Sequence[Effect]) -> Array:
        del noise_effects
        readings = zip(CHANNELS, self.predict(variants, range(self.fit_trials)), strict=True)
        white = [disturbances.whitened(values / self._sd[channel], self.plan.lag1) for channel, values in readings]
        return np.concatenate([z.reshape(len(variants), -1) for z in white], axis=1)

    def produce(self, variant: Variant, rng: np.random.Generator) -> CaseFiles:
        plan, rows = self.plan, self.trials * self.samples
        amps, speed = self.predict([variant], range(self.trials))
        masks = disturbances.outlier_masks(rng, rows, CHANNELS, plan)
        trial = np.repeat(np.arange(1, self.trials + 1), self.samples)
        session = (np.arange(rows) + 1) * DT_S
        columns = self._inputs(trial, session, 0)
        columns = {
            "trial": columns["trial"],
            "split": (np.where(trial > self.fit_trials, "holdout", "fit"), "%s"),
        } | columns
        for channel, clean in (("current_A", amps[0]), ("omega_rad_s", speed[0])):
            step, sd = _resolution(self.stated[channel]), self._sd[channel]
            values = (
                clean + sd * disturbances.correlated_noise(rng, clean.shape, plan.lag1, plan.tail_degrees)
            ).ravel()
            values = values + np.where(masks[channel], disturbances.spikes(rng, np.full(rows, sd)), 0.0)
            values = np.round(values / step) * step
            values = np.where(disturbances.dropouts(rng, rows, plan.dropout_share), np.nan, values)
            columns[channel] = (values, f"%.{max(0, int(-np.floor(np.log10(step) + 1e-9)))}f")
        later = session[-1] + np.arange(1, 2 * self.samples + 1) * DT_S
        blind = self._inputs(np.repeat([1, 2], self.samples), later, self.trials)
        section = self.motor.section(self.tolerance_names)
        section["motor_side_inertia_fraction"] = self.inertia_share
        section["motor_side_friction_fraction"] = self.friction_share
        nominal = {"kind": self.KIND, "motor": section, "sample_rate_Hz": 200, "noise": self.stated}
        return CaseFiles(nominal, {"data.csv": columns, "blind_inputs.csv": blind})

    def _inputs(self, trial: Array, session_s: Array, first: int) -> Table:
        """Return the columns of trials, times and voltages from that trial on."""
        trials = len(trial) // self.samples
        return {
            "trial": (trial, "%d"),
            "session_time_s": (session_s, "%.4f"),
            "t_s": (np.tile(np.arange(1, self.samples + 1) * DT_S, trials), "%.4f"),
            "u_cmd_V": (self.u_V[first : first + trials].ravel(), "%.3f"),
        }

    def describe(self) -> dict[str, Any]:
        return {"layout": self.styles[: self.trials], "rows": self.trials * self.samples}
