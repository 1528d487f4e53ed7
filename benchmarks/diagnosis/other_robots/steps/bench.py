"""Readings of some trials of a motor with its load."""

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import simulate_trials
from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.effects import Key, Table, columns
from benchmarks.diagnosis.other_robots.motor import Motor
from benchmarks.diagnosis.other_robots.steps.commands import DT_S

NOMINAL = 5
"""Parameters with a tolerance: R, K, B, Tc, J."""
ORDER = [
    "R",
    "K",
    "B",
    "Tc",
    "J",
    "extra",
    "vs",
    "asym",
    "drop",
    "rs",
    "delay",
    "lag",
    "limit",
    "gap",
    "fj",
    "ff",
    "filt",
    "wlate",
    "ripa",
    "ripn",
    "ripp",
    "vsup",
    "ind",
    "spring",
    "slew",
    "trip",
    "tript",
    "ecc",
    "eccp",
    "umin",
    "rheat",
    "mheat",
    "flexk",
    "flexd",
    "clock",
    "ifilt",
    "tcramp",
]
"""Order of the parameters in motors.c."""
FACTORS = {
    "winding_resistance_scale": "R",
    "torque_constant_scale": "K",
    "viscous_friction_scale": "B",
    "coulomb_friction_scale": "Tc",
    "rotor_inertia_scale": "J",
}
"""Parameters of motors.c that an effect multiplies."""
PARAMETERS = {
    "stribeck_friction": ["extra", "vs"],
    "friction_asymmetry": ["asym"],
    "bridge_voltage_drop": ["drop"],
    "supply_sag": ["rs"],
    "input_delay": ["delay"],
    "actuator_lag": ["lag"],
    "current_limit": ["limit"],
    "gear_backlash": ["gap"],
    "speed_filter_lag": ["filt"],
    "speed_time_offset": ["wlate"],
    "torque_ripple": ["ripa", "ripn", "ripp"],
    "inductance": ["ind"],
    "cable_winds_up": ["spring"],
    "slew_rate": ["slew"],
    "bridge_trips": ["trip", "tript"],
    "encoder_disc_off_centre": ["ecc", "eccp"],
    "minimum_pulse": ["umin"],
    "winding_heating": ["rheat"],
    "magnet_heating": ["mheat"],
    "flexible_shaft": ["flexk", "flexd"],
    "speed_clock_drifts": ["clock"],
    "current_filtered": ["ifilt"],
    "friction_grows": ["tcramp"],
}
"""Parameters of motors.c that an effect sets. All other effects act on the readings."""


class StepBench:
    """The commands of some trials and the model of their readings."""

    def __init__(
        self, motor: Motor, commands: Array, starts: Array, *, session: float, shares: tuple[float, float], top: float
    ) -> None:
        self.motor, self.commands, self.starts, self.session = motor, commands, starts, session
        self.shares, self.top = shares, top

    def readings(self, table: Table, keys: list[Key], thetas: Array, substeps: int = 5) -> Array:
        """Return currents of all trials and, behind them, speeds, without noise."""
        defaults = {"vs": 1.0, "limit": 1e9, "fj": self.shares[0], "ff": self.shares[1], "vsup": self.motor.supply}
        block = np.tile([defaults.get(name, 0.0) for name in ORDER], (len(thetas), 1))
        for name, column in self.motor.individual(thetas[:, :NOMINAL]).items():
            block[:, ORDER.index(name)] = column[:, 0]
        sensors = {}
        for (name, _), values in columns(table, keys, thetas, NOMINAL):
            if name in FACTORS:
                block[:, ORDER.index(FACTORS[name])] *= values[0]
            elif name in PARAMETERS:
                for column, value in zip(PARAMETERS[name], values, strict=True):
                    block[:, ORDER.index(column)] = value
            else:
                sensors[name] = values[0][:, None, None]
        i, w = simulate_trials(block, self.commands, self.starts, session=self.session, substeps=substeps, dt=DT_S)
        return np.concatenate([part.reshape(len(thetas), -1) for part in self._read(sensors, i, w)], axis=1)

    def _read(self, sensors: dict[str, Array], i: Array, w: Array) -> tuple[Array, Array]:
        """Return what the sensors read."""
        pick_up = sensors.get("current_picks_up_speed", 0.0) * self.top / self.motor.R
        i = sensors.get("current_sensor_gain", 1.0) * i + sensors.get("current_sensor_offset", 0.0)
        i = i + pick_up * (w * self.motor.K / self.top)
        highest = sensors.get("current_clamped", 1e9)
        i = np.clip(i, -highest, highest)
        highest = sensors.get("speed_clamped", 1e9)
        w = np.clip(sensors.get("speed_scale", 1.0) * w, -highest, highest)
        step = sensors.get("speed_coarse")
        return i, w if step is None else np.round(w / step) * step
