"""Parameters of the wheels in motors.c, and the encoders' lost ticks."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.drives.robot import NOMINAL, Robot
from benchmarks.diagnosis.other_robots.effects import Key, Table, columns

MOTOR = 5
"""Parameters of the motor with a tolerance: R, K, B, Tc, J."""
ORDER = ["R", "K", "B", "Tc", "J", "mis", "drop", "rs", "decl", "delay", "vs", "turn", "umin", "heat"]
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
    "torque_constant_mismatch": "mis",
    "bridge_voltage_drop": "drop",
    "supply_sag": "rs",
    "battery_decline": "decl",
    "input_delay": "delay",
    "loaded_by_turning": "turn",
    "minimum_pulse": "umin",
    "winding_heating": "heat",
}
"""Parameters of motors.c that an effect sets."""


def wheel_parameters(bot: Robot, table: Table, keys: list[Key], thetas: Array) -> Array:
    """Return the wheel parameters of motors.c, a row per variant."""
    block = np.zeros((len(thetas), len(ORDER)))
    for name, column in bot.motor.individual(thetas[:, :MOTOR]).items():
        block[:, ORDER.index(name)] = column[:, 0]
    block[:, ORDER.index("vs")] = bot.motor.supply
    for (name, _), values in columns(table, keys, thetas, NOMINAL):
        if name in FACTORS:
            block[:, ORDER.index(FACTORS[name])] *= values[0]
        elif name in PARAMETERS:
            block[:, ORDER.index(PARAMETERS[name])] = values[0]
    return block


def missed_share(w: Array | float, missed: list[float]) -> Array:
    """Return the share of the ticks that an encoder misses at a wheel speed, from fraction and threshold."""
    fraction, threshold = missed
    return fraction / (1 + np.exp(-np.clip((np.abs(w) - threshold) / 0.3, -50, 50)))
