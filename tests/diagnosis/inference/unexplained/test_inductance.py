"""The inductance of a winding, which the simulator neglects: the motor is integrated here."""

import numpy as np
import pytest

from diagnosis.importers.motor_step import IMPORTER

R, K, B, TC, J, SAMPLE_S, STEPS = 3.0, 0.3, 0.002, 0.02, 0.003, 0.005, 50
CURRENT_A, SPEED_RAD_S = 0.004, 0.05
NOMINAL = f"""kind: motor_step
sample_rate_Hz: 200
motor:
  winding_resistance_ohm: {{value: {R}, tolerance: 0.06}}
  torque_constant_N_m_A: {{value: {K}, tolerance: 0.006}}
  viscous_friction_N_m_s_rad: {{value: {B}, tolerance: 0.0002}}
  coulomb_friction_N_m: {{value: {TC}, tolerance: 0.001}}
  rotor_inertia_kg_m2: {{value: {J}, tolerance: 0.00015}}
  supply_voltage_V: 7.4
  motor_side_inertia_fraction: 0.6
  motor_side_friction_fraction: 0.5
noise: {{current_A: {CURRENT_A}, omega_rad_s: {SPEED_RAD_S}, lag1_correlation: 0.0}}
"""
TRIALS_V = ((4.0, 1.5, 5.0), (-3.0, 2.0, -5.0), (5.0, 0.0, 3.0), (2.5, -4.0, 1.0))


def motion(volts, inductance_H, lag_s):
    """Currents and speeds at the samples, by Euler steps of 0.1 ms; the voltage follows the command with a lag."""
    amperes, rad_s, applied_V, step_s, rows = 0.0, 0.0, 0.0, SAMPLE_S / STEPS, []
    for volt in volts:
        for _ in range(STEPS):
            applied_V += (volt - applied_V) * (1.0 if lag_s == 0.0 else -np.expm1(-step_s / lag_s))
            goal = (applied_V - K * rad_s) / R
            amperes += (goal - amperes) * (1.0 if inductance_H == 0.0 else -np.expm1(-step_s * R / inductance_H))
            drive = K * amperes
            friction = np.clip(drive, -TC, TC) if rad_s == 0.0 else TC * np.sign(rad_s)
            faster = rad_s + step_s / J * (drive - B * rad_s - friction)
            rad_s = 0.0 if faster * rad_s < 0.0 else faster
        rows.append((amperes, rad_s))
    return np.array(rows)


def step_log(folder, inductance_H=0.0, lag_s=0.0):
    rng = np.random.default_rng(3)
    lines = ["trial,split,session_time_s,t_s,u_cmd_V,current_A,omega_rad_s"]
    for k, levels in enumerate(TRIALS_V):
        volts = np.repeat(levels, 60)
        read = motion(volts, inductance_H, lag_s) + [CURRENT_A, SPEED_RAD_S] * rng.standard_normal((len(volts), 2))
        for i, (volt, (amperes, rad_s)) in enumerate(zip(volts, read, strict=True), start=1):
            t_s, split = i * SAMPLE_S, "holdout" if k == len(TRIALS_V) - 1 else "fit"
            lines.append(f"{k + 1},{split},{2.0 * k + t_s:.3f},{t_s:.3f},{volt},{amperes:.5f},{rad_s:.5f}")
    (folder / "nominal.yaml").write_text(NOMINAL, encoding="utf-8")
    (folder / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return IMPORTER.read(folder)


@pytest.mark.parametrize("time_constant_s", [0.003, 0.005])
def test_the_inductance_of_a_winding_is_no_lag_of_the_driver(tmp_path, diagnosed_among, time_constant_s):
    measurement = step_log(tmp_path, inductance_H=time_constant_s * R)
    answer = diagnosed_among(measurement, "actuator_lag", "input_delay", "rotor_inertia_scale").answer()
    assert answer["effects"] == []
    assert answer["unexplained"]


def test_a_lag_of_the_driver_is_no_inductance(tmp_path, diagnosed_among):
    measurement = step_log(tmp_path, lag_s=0.005)
    answer = diagnosed_among(measurement, "actuator_lag", "input_delay", "rotor_inertia_scale").answer()
    assert [each["name"] for each in answer["effects"]] == ["actuator_lag"]
    assert answer["effects"][0]["parameters"]["time_constant_s"] == pytest.approx(0.005, rel=0.05)
    assert answer["effects"][0]["confidence"] > 0.95
