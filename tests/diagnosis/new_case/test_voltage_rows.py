"""Which row a logged voltage belongs to: the check from the data, and the key of the mapping that moves it."""

import csv
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.diagnosis.new_case.drives import SLOPE, TICKS, J, K, R

STEP_S, ROWS = 0.02, 600
KNOWN = ("--set", f"winding_resistance_ohm={R}", "--set", f"torque_constant_N_m_A={K}", "--set", "supply_voltage_V=7.4")


def held_V():
    """Voltages (ROWS,), each held from its instant to the next one and for 15 to 59 instants."""
    rng = np.random.Generator(np.random.PCG64(3))
    return np.repeat(rng.choice([-7.0, -4.0, 0.0, 3.0, 5.0, 7.0], 60), rng.integers(15, 60, 60))[:ROWS]


def speeds(volts, step_s):
    """Speed (ROWS,) at each instant of a motor without dry friction, w' = (u / SLOPE - w) / tau, from rest."""
    decay, result = np.exp(-step_s * SLOPE * K / (R * J)), np.zeros(len(volts))
    for row, volt in enumerate(volts[:-1]):
        result[row + 1] = decay * result[row] + (1.0 - decay) * volt / SLOPE
    return result


@pytest.fixture
def bench():
    """Return the log of a bench whose row has the voltage that was set `later` rows after the row before."""

    def log(later):
        volts, rng = held_V(), np.random.Generator(np.random.PCG64(8))
        speed, before = speeds(volts, STEP_S), np.concatenate([[0.0], volts[:-1]])
        current = (before - K * speed) / R
        rows = np.arange(1, ROWS - 1)
        return {
            "t [s]": np.round(STEP_S * rows, 6),
            "u [V]": before[rows + later],
            "current [A]": np.round(current + rng.normal(0.0, 0.01, ROWS), 4)[rows],
            "speed [rad/s]": np.round(speed + rng.normal(0.0, 0.1, ROWS), 3)[rows],
        }

    return log


def remapped(init, columns, *known, **held):
    """Make the case again with `held` of the voltages in its mapping."""
    mapping = yaml.safe_load(Path("run/mapping.yaml").read_text())
    for name, value in held.items():
        mapping["columns"][name]["held"] = value
    Path("m.yaml").write_text(yaml.safe_dump(mapping))
    return init(columns, "--mapping", "m.yaml", "--out", "again", *KNOWN, *known)


def test_the_voltage_since_the_row_before_gives_no_check(init, bench):
    code, out, err, _ = init(bench(0), *KNOWN)
    assert (code, err) == (0, "")
    assert "CHECK" not in out


@pytest.mark.parametrize("missing", ["current [A]", "speed [rad/s]", ""])
def test_the_voltage_until_the_next_row_is_named_with_the_key_that_moves_it(missing, init, bench):
    columns = {name: values for name, values in bench(1).items() if name != missing}
    _, out, _, _ = init(columns, *KNOWN)
    (check,) = [line for line in out.splitlines() if line.startswith("CHECK")]
    assert check.startswith("CHECK u_cmd_V: the motor follows the voltage of the row before")
    assert "held: after_row" in check
    assert check.endswith("20 ms, late")
    code, out, err, _ = remapped(init, columns, u_cmd_V="after_row")
    assert (code, err) == (0, "")
    assert "CHECK" not in out
    voltages = [float(row["u_cmd_V"]) for row in csv.DictReader(Path("again/data.csv").read_text().splitlines())]
    # The first row is left out: nobody knows the voltage before it.
    np.testing.assert_allclose(voltages, bench(0)["u [V]"][1:])


def test_a_motor_that_knows_the_next_voltage_is_named(init, bench):
    _, out, _, _ = init(bench(-1), *KNOWN)
    (check,) = [line for line in out.splitlines() if line.startswith("CHECK")]
    assert "follows the voltage of the next row" in check
    assert check.endswith("give the readings time_offset_s: 0.02 in the mapping")


def test_a_drive_with_the_voltages_since_the_row_before_is_named_with_the_key_that_moves_them(init):
    step_s = 0.05
    left, right = held_V(), held_V()[::-1].copy()
    columns = {"time [s]": np.round(step_s * np.arange(1, ROWS), 6)}
    for side, volts in (("left", left), ("right", right)):
        tau_s, speed = R * J / (SLOPE * K), speeds(volts, step_s)
        # The turn over a row is the integral of the speed, which goes from one end to the other exponentially.
        turned = volts / SLOPE * step_s + tau_s * (speed - np.append(speed[1:], speed[-1]))
        angle = np.concatenate([[0.0], np.cumsum(turned)[:-1]])
        columns[f"enc_{side}"] = np.round(TICKS / (2.0 * np.pi) * angle).astype(int)[1:]
        columns[f"u_{side} [V]"] = volts[:-1]
    known = ("--set", f"ticks_per_turn={TICKS}")
    _, out, _, _ = init(columns, *KNOWN, *known)
    (check,) = [line for line in out.splitlines() if line.startswith("CHECK")]
    assert check.startswith("CHECK u_left_V and u_right_V: the wheels follow the voltage of the next row")
    assert check.endswith("give both voltages held: before_row in the mapping")
    _, out, err, _ = remapped(init, columns, *known, u_left_V="before_row", u_right_V="before_row")
    assert err == ""
    assert "CHECK" not in out
    assert "follow the voltages of the next row" not in out


def test_held_is_for_voltages_of_time_series(init, bench):
    columns = bench(0)
    init(columns, *KNOWN)
    code, _, err, _ = remapped(init, columns, omega_rad_s="after_row")
    assert code == 2
    assert "columns.omega_rad_s: held is for the voltages of a drive or of a step log" in err
