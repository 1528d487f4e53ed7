"""Logs of controllers that change the voltages between the rows; the robot is integrated here, by Euler's method."""

from collections.abc import Iterator
from math import floor, pi
from pathlib import Path

import numpy as np
import pytest

from diagnosis.diagnose import Diagnosis, diagnose
from diagnosis.importers.drive_log import IMPORTER
from diagnosis.measured.measurement import Measurement

OHM, CONSTANT, VISCOUS, COULOMB_N_M, INERTIA = 3.5, 0.3, 0.002, 0.025, 0.0032
TICKS, ROW_S, STEP_S = 1440, 0.05, 1e-3
NOMINAL = f"""kind: drive_log
motor:
  winding_resistance_ohm: {{value: {OHM}, tolerance: 0.17}}
  torque_constant_N_m_A: {{value: {CONSTANT}, tolerance: 0.015}}
  viscous_friction_N_m_s_rad: {{value: {VISCOUS}, tolerance: 0.0005}}
  coulomb_friction_N_m: {{value: {COULOMB_N_M}, tolerance: 0.004}}
  rotor_inertia_kg_m2: {{value: {INERTIA}, tolerance: 0.0003}}
  supply_voltage_V: 7.4
robot:
  wheel_radius_m: {{value: 0.0325, tolerance: 0.0002}}
  wheel_separation_m: {{value: 0.14, tolerance: 0.0014}}
  encoder_ticks_per_revolution: {TICKS}
noise: {{wheel_speed_rad_s: 0.045, pose_xy_m: 0.001, pose_theta_rad: 0.003, travel_m_per_sqrt_m: 0.001,
  tof_polynomial_mm: [1, 0, 0, 0], tof_polynomial_origin_m: 0.18}}
"""
HEADER = (
    "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks,"
    "tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"
)
NOTE = "log the voltages as often as they change"


def wheel(rng: np.random.Generator, cycle_s: float, lasts_s: float) -> Iterator[tuple[float, int]]:
    """Yield the voltage and the ticks of a wheel in each row, which is taken just after a cycle of its controller."""
    speed = angle = volts = integral = target = changes_at = next_cycle = next_row = 0.0
    for step in range(round(lasts_s / STEP_S) + 1):
        t_s = step * STEP_S + 1e-9
        if t_s > next_cycle:
            if t_s > changes_at:
                changes_at, target = t_s + rng.uniform(0.5, 2.0), rng.uniform(1.0, 6.0)
            integral += (target - speed) * cycle_s / 0.3
            volts = round(0.3 * (target - speed + integral) + CONSTANT * target, 3)
            next_cycle += cycle_s
        if t_s > next_row:
            yield volts, floor(angle * TICKS / (2.0 * pi))
            next_row += ROW_S
        torque = CONSTANT * (volts - CONSTANT * speed) / OHM - VISCOUS * speed
        # The controller only drives forward, so that no wheel turns back.
        after = max(speed + STEP_S / INERTIA * (torque - COULOMB_N_M), 0.0)
        angle += 0.5 * (speed + after) * STEP_S
        speed = after


def log(folder: Path, cycle_s: float, lasts_s: float) -> Measurement:
    """Return the log of a robot whose wheels are regulated with this cycle."""
    rng = np.random.default_rng(4)
    left, right = list(wheel(rng, cycle_s, lasts_s)), list(wheel(rng, cycle_s, lasts_s))
    rows = [HEADER]
    for k, ((left_V, left_ticks), (right_V, right_ticks)) in enumerate(zip(left, right, strict=True)):
        split, t_s = "fit" if k < 0.75 * len(left) else "holdout", f"{k * ROW_S:.3f}"
        rows.append(f"1,{split},{t_s},{t_s},,,{left_V},{right_V},{left_ticks},{right_ticks},,,,,,")
    (folder / "nominal.yaml").write_text(NOMINAL)
    (folder / "data.csv").write_text("\n".join([*rows, ""]))
    return IMPORTER.read(folder)


@pytest.fixture(scope="module")
def between_rows(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    return diagnose(log(tmp_path_factory.mktemp("fast"), 0.02, lasts_s=12.0))


def test_voltages_that_change_between_the_rows_are_no_effect_of_a_textbook_robot(between_rows):
    assert between_rows.names == ()
    assert between_rows.unexplained is None


def test_a_note_says_that_the_wheels_follow_voltages_before_they_are_logged(tmp_path):
    assert any(NOTE in note for note in log(tmp_path, 0.02, lasts_s=25.0).notes)


def test_the_part_of_a_change_that_acts_early_is_that_of_the_controller(between_rows):
    # The changes at five cycles in two rows have acted for 0, 0.6, 0.2, 0.8 and 0.4 of a row; large ones count most.
    early = between_rows.early_voltages
    assert early is not None
    assert 0.2 < early.mean < 0.8
    assert early.sd > 0.1


def test_a_controller_in_step_with_the_rows_gets_no_note(tmp_path):
    """In a log that is long enough for the note on a faster one."""
    assert not any(NOTE in note for note in log(tmp_path, ROW_S, lasts_s=25.0).notes)


def test_a_controller_in_step_with_the_rows_has_no_early_voltages(tmp_path):
    result = diagnose(log(tmp_path, ROW_S, lasts_s=12.0))
    assert result.early_voltages is None
    assert result.names == ()


@pytest.mark.parametrize(
    "voltage_V",
    [np.full(400, 3.0), np.repeat([3.0, 4.0], 200), np.repeat([3.0, 1.0, 4.0, 2.0], 100), np.linspace(1.0, 5.0, 400)],
    ids=["constant", "one step", "steps", "ramp"],
)
def test_turns_by_the_voltage_of_their_row_get_no_note(voltage_V, tmp_path):
    """A voltage that hardly changes says little about the row in which it acts."""
    turns = 20.0 * voltage_V[:-1] + np.random.default_rng(0).normal(0.0, 0.3, 399)
    ticks = np.floor(np.concatenate([[0.0], np.cumsum(turns)]))
    rows = [
        f"1,fit,{k * ROW_S:.3f},{k * ROW_S:.3f},,,{u:.3f},{u:.3f},{n:.0f},{n:.0f},,,,,,"
        for k, (u, n) in enumerate(zip(voltage_V, ticks, strict=True))
    ]
    (tmp_path / "nominal.yaml").write_text(NOMINAL)
    (tmp_path / "data.csv").write_text("\n".join([HEADER, *rows, ""]))
    assert not any(NOTE in note for note in IMPORTER.read(tmp_path).notes)
