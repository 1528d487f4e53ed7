"""Cases of kind motor_steady: voltage sweeps with one steady state a row."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases import disturbances
from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.motors import motor_effects, steady_outside
from benchmarks.diagnosis.independent_cases.motors.motor import draw_individual, draw_motor
from benchmarks.diagnosis.independent_cases.motors.motor_effects import apply_motor, motor_recipe
from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, plain_law
from benchmarks.diagnosis.independent_cases.motors.steady_state import solve
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Recipe, Variant
from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Setting, Table

FORMATS = {"current_A": "%.6f", "omega_rad_s": "%.5f"}


def _sweeps(rng: np.random.Generator, top_V: float) -> tuple[Array, Array, str]:
    """Draw voltages (V) and sweep numbers of the rows in the order they were taken, and the name of the layout."""
    points = int(pick(rng, [21, 21, 21, 16, 26]))
    up = np.linspace(0, top_V, points)
    down = up[::-1]
    layout = pick(rng, ["eight", "eight", "eight", "four", "one", "two", "plus_minus", "shuffled"])
    if layout == "one":
        sweeps = [np.linspace(0, top_V, int(pick(rng, [21, 21, 31])))]
    elif layout == "shuffled":
        both = np.concatenate([up, -up[1:]])
        sweeps = [rng.permutation(both) for _ in range(int(rng.integers(1, 5)))]
    else:
        four = [up, down, -up, -down]
        sweeps = {"eight": four * 2, "four": four, "two": four[:2], "plus_minus": [up, -up]}[layout]
    number = np.repeat(np.arange(1, len(sweeps) + 1), [len(sweep) for sweep in sweeps])
    return np.round(np.concatenate(sweeps), 4), number, layout


class SteadySetting(Setting):
    """Bench of steady states."""

    KIND = "motor_steady"
    PLACE = motor_effects.places_of("steady")
    OUTSIDE = list(steady_outside.RECIPES)
    tolerance_names = ["R", "K", "B", "Tc"]

    def __init__(self, rng: np.random.Generator) -> None:
        """Draw motor, sweeps, individual and noise."""
        self.motor = draw_motor(rng)
        self.top_voltage_V = round(self.motor.supply_V * rng.uniform(0.6, 1.0), 1)
        self.u_V, self.sweep, self.layout = _sweeps(rng, self.top_voltage_V)
        self.t_s = np.arange(len(self.u_V)) * pick(rng, [2.0, 3.0, 3.0, 5.0, 8.0])
        self.holdout = np.arange(len(self.u_V)) % 4 == 2
        if len(self.u_V) >= 80:
            self.holdout = self.sweep > (3 * self.sweep[-1]) // 4
        self.tolerance_factor = disturbances.draw_tolerance_factor(rng)
        self.top_speed_rad_s = self.top_voltage_V / self.motor.value("K")
        friction = self.motor.value("Tc") + self.motor.value("B") * self.top_speed_rad_s
        self.idle_A = friction / self.motor.value("K")
        self.stated = {
            "current_A": significant(self.idle_A * log_uniform(rng, 0.004, 0.03), 2),
            "omega_rad_s": significant(self.top_speed_rad_s * log_uniform(rng, 0.0015, 0.01), 2),
        }
        self.individual = draw_individual(rng, self.motor.nominal, self.tolerance_factor)
        self.plan = disturbances.draw_plan(rng, list(FORMATS))

    def plausible(self, variant: Variant) -> bool:
        """Return whether the motor turns in at least two fifths of the rows."""
        return bool(np.mean(self.predict([variant], self.t_s, self.u_V)[1] != 0) > 0.4)

    def recipe(self, name: str, rng: np.random.Generator) -> Recipe:
        speed, span = self.top_speed_rad_s, self.t_s[-1]
        if name in self.PLACE:
            use = {"top_voltage_V": self.top_voltage_V, "duration_s": span, "top_speed_rad_s": speed}
            return motor_recipe(name, rng, self.motor, **use)
        direction, when, tc = draw_sign(rng), float(rng.uniform(0.25, 0.7) * span), self.motor.value("Tc")
        draft = steady_outside.SteadyDraft(name, "outside", rng, direction, when, span, tc, speed, self.idle_A)
        return steady_outside.RECIPES[name](draft)

    def predict(self, variants: Sequence[Variant], t_s: Array, u_V: Array) -> tuple[Array, Array]:
        """Return clean readings: currents (A) and speeds (rad/s), each (variants, rows)."""
        laws = []
        for variant in variants:
            law = plain_law(variant.individual(self.individual, self.motor.nominal), self.motor.supply_V)
            for effect in variant.effects:
                apply_motor(law, effect, t_s)
            for effect in variant.outside:
                steady_outside.change_law(law, effect, t_s, u_V, self.top_voltage_V)
            laws.append(law)
        amps, speed = solve(Lanes.stack(laws), u_V)
        for i, variant in enumerate(variants):
            for effect in variant.outside:
                amps[i], speed[i] = steady_outside.change_reading(amps[i], speed[i], effect, t_s, self.t_s[-1])
            amps[i], speed[i] = read_by_sensors(amps[i], speed[i], variant)
        return amps, speed

    @property
    def _sd(self) -> dict[str, float]:
        """True noise of current (A) and speed (rad/s)."""
        return {c: self.stated[c] * self.plan.noise_factor[c] for c in FORMATS}

    def signatures(self, variants: Sequence[Variant], noise_effects: Sequence[Effect]) -> Array:
        del noise_effects
        readings = zip(FORMATS, self.predict(variants, self.t_s, self.u_V), strict=True)
        white = [
            disturbances.whitened(values / self._sd[c], self.plan.lag1)[:, ~self.holdout] for c, values in readings
        ]
        return np.concatenate(white, axis=1)

    def produce(self, variant: Variant, rng: np.random.Generator) -> CaseFiles:
        rows, plan, sd = len(self.u_V), self.plan, self._sd
        amps, speed = self.predict([variant], self.t_s, self.u_V)
        masks = disturbances.outlier_masks(rng, rows, list(FORMATS), plan)
        columns: Table = {
            "row": (np.arange(1, rows + 1), "%d"),
            "sweep": (self.sweep, "%d"),
            "split": (np.where(self.holdout, "holdout", "fit"), "%s"),
            "t_s": (self.t_s, "%.1f"),
            "u_cmd_V": (self.u_V, "%.4f"),
        }
        for channel, clean in (("current_A", amps[0]), ("omega_rad_s", speed[0])):
            values = clean + sd[channel] * disturbances.correlated_noise(rng, (rows,), plan.lag1, plan.tail_degrees)
            if channel == "omega_rad_s":
                values = np.where(clean == 0, 0.0, values)  # a counter of a motor at rest has no noise
            spikes = disturbances.spikes(rng, np.full(rows, sd[channel]))
            values = values + np.where(masks[channel], spikes, 0.0)
            values = np.where(disturbances.dropouts(rng, rows, plan.dropout_share), np.nan, values)
            columns[channel] = (values, FORMATS[channel])
        nominal = {"kind": self.KIND, "motor": self.motor.section(self.tolerance_names), "noise": self.stated}
        return CaseFiles(nominal, {"data.csv": columns, "blind_inputs.csv": self._blind(rng)})

    def _blind(self, rng: np.random.Generator) -> Table:
        """Draw the inputs of unseen rows, which follow the data."""
        low = -1 if np.any(self.u_V < 0) else 0
        later = np.round(rng.uniform(low, 1, int(pick(rng, [15, 30]))) * self.top_voltage_V, 3)
        number = np.arange(1, len(later) + 1)
        t = self.t_s[-1] + (self.t_s[1] - self.t_s[0]) * number
        return {"row": (number, "%d"), "t_s": (t, "%.1f"), "u_cmd_V": (later, "%.4f")}

    def describe(self) -> dict[str, Any]:
        return {"layout": self.layout, "rows": len(self.u_V), "rows_fit": int((~self.holdout).sum())}


def read_by_sensors(amps: Array, speed: Array, variant: Variant) -> tuple[Array, Array]:
    """Return the readings of current (A) and speed (rad/s) after the listed effects of gain and offset."""
    parameters = dict(variant.effects)
    if "current_sensor_gain" in parameters:
        amps = amps * parameters["current_sensor_gain"]["gain"]
    if "current_sensor_offset" in parameters:
        amps = amps + parameters["current_sensor_offset"]["offset_A"]
    if "speed_scale" in parameters:
        speed = speed * parameters["speed_scale"]["scale"]
    return amps, speed
