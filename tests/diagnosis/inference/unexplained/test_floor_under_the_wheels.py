"""Friction of a floor that depends on the place: both wheels are moved here by their exact responses in small steps."""

from math import exp, pi

import numpy as np

from diagnosis.case_robot import base_robot_of, nominal_of, spreads_of
from diagnosis.diagnose import diagnose
from diagnosis.importers.drive_log import IMPORTER
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.noise_level import with_estimated_noises
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.unexplained.adequacy import LEVEL, adequacy
from diagnosis.predictors.drive_log import drive_log_stages
from diagnosis.report.plots.unexplained import shown_residuals
from diagnosis.report.report_data import report_data
from diagnosis.report.summary import summary

OHM, K, B, COULOMB, INERTIA = 5.0, 0.3, 0.001, 0.015, 0.0008
RADIUS_M, TRACK_M, TICKS, ROW_S, ROWS, STEPS = 0.03, 0.15, 480, 0.05, 150, 25
XY_M, THETA_RAD, TORQUE_N_M = 0.002, 0.002, 0.003
NOMINAL = f"""kind: drive_log
motor:
  winding_resistance_ohm: {{value: {OHM}, tolerance: 0.05}}
  torque_constant_N_m_A: {{value: {K}, tolerance: 0.002}}
  viscous_friction_N_m_s_rad: {{value: {B}, tolerance: 0.0001}}
  coulomb_friction_N_m: {{value: {COULOMB}, tolerance: 0.0008}}
  rotor_inertia_kg_m2: {{value: {INERTIA}, tolerance: 0.00001}}
  supply_voltage_V: 6
robot:
  wheel_radius_m: {{value: {RADIUS_M}, tolerance: 0.00003}}
  wheel_separation_m: {{value: {TRACK_M}, tolerance: 0.0006}}
  encoder_ticks_per_revolution: {TICKS}
noise: {{wheel_speed_rad_s: 0.15, pose_xy_m: {XY_M}, pose_theta_rad: {THETA_RAD}, travel_m_per_sqrt_m: 0.0005,
  tof_polynomial_mm: [1, 0, 0, 0], tof_polynomial_origin_m: 0.18}}
"""
HEADER = (
    "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks,"
    "tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"
)


def no_floor(_place_m):
    return 0.0


def strips(place_m):
    """Strips of 3 cm, one in each 25 cm along x."""
    return 0.008 * (place_m[0] % 0.25 < 0.03)


def patch(place_m):
    """A patch with a radius of 15 cm."""
    return 0.006 * (np.hypot(*(place_m - [0.05, 0.0])) < 0.15)


def driven(rng, floor):
    """Rows of voltages, counts and poses of a drive to and fro about (0, 0).

    Args:
        rng: Random numbers.
        floor: Torque by the floor against the motion, by the place of a wheel.
    """
    pose, speed, angle, rows = np.array([0.0, 0.0, rng.uniform(-pi, pi)]), np.zeros(2), rng.uniform(0.0, 1.0, 2), []
    step_s, damping = ROW_S / STEPS, B + K**2 / OHM
    kept = exp(-step_s * damping / INERTIA)
    voltage_V = np.zeros(2)
    for k in range(ROWS):
        if k % 12 == 0:
            ahead = pose[0] * np.cos(pose[2]) + pose[1] * np.sin(pose[2])
            voltage_V = rng.uniform(2.0, 4.0) * (-1.0 if ahead > 0.0 else 1.0) * rng.uniform(0.8, 1.2, 2).round(3)
        noisy = pose + [XY_M, XY_M, THETA_RAD] * rng.standard_normal(3)
        rows.append([*voltage_V, *np.floor(angle * TICKS / (2.0 * pi)), *noisy])
        disturbance = TORQUE_N_M * rng.standard_normal(2)
        for _ in range(STEPS):
            across = 0.5 * TRACK_M * np.array([-np.sin(pose[2]), np.cos(pose[2])])
            brake = COULOMB + np.array([floor(pose[:2] + across), floor(pose[:2] - across)])
            drive = K * voltage_V / OHM + disturbance
            moves = (speed != 0.0) | (np.abs(drive) > brake)
            sign = np.where(speed != 0.0, np.sign(speed), np.sign(drive))
            end = (drive - sign * brake) / damping
            after = np.where(moves, end + (speed - end) * kept, 0.0)
            after = np.where(after * sign < 0.0, 0.0, after)
            turned = 0.5 * (speed + after) * step_s
            speed, angle = after, angle + turned
            forward, turn = RADIUS_M * turned.mean(), RADIUS_M * (turned[1] - turned[0]) / TRACK_M
            heading = pose[2] + 0.5 * turn
            pose = pose + np.array([forward * np.cos(heading), forward * np.sin(heading), turn])
    return rows


def case(folder, seed, floor):
    """The measurement of four trials, the last one held out."""
    lines, rng = [HEADER], np.random.default_rng(seed)
    for trial in range(4):
        for k, (left_V, right_V, left, right, x, y, theta) in enumerate(driven(rng, floor)):
            t, split = k * ROW_S, "holdout" if trial == 3 else "fit"
            cells = [trial, split, f"{20.0 * trial + t:.2f}", f"{t:.2f}", "", "", f"{left_V:.3f}", f"{right_V:.3f}"]
            cells += [int(left), int(right), "", "", "", f"{x:.4f}", f"{y:.4f}", f"{theta:.4f}"]
            lines.append(",".join(map(str, cells)))
    (folder / "nominal.yaml").write_text(NOMINAL, encoding="utf-8")
    (folder / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return IMPORTER.read(folder)


def structures(measurement):
    """The structures that the nominal robot leaves."""
    robot = nominal_of(measurement, base_robot_of(measurement, None))
    evidence, bare = Evidence(drive_log_stages(measurement, robot)), Hypothesis(robot, spreads_of(measurement, robot))
    for _ in range(2):
        (fit,) = fits(evidence, [(bare, bare.null())])
        evidence = with_estimated_noises(evidence, fit)
    (fit,) = fits(evidence, [(bare, bare.null())])
    return adequacy(evidence, fit).structures


def test_a_patch_of_more_friction_is_seen_where_it_is(tmp_path):
    first = structures(case(tmp_path, 1, patch))[0]
    assert (first.channel, first.covariate) == ("wheel_speed_rad_s", "position")
    assert first.p < LEVEL
    assert first.what == "friction in patches"


def test_an_even_floor_leaves_nothing(tmp_path):
    assert structures(case(tmp_path, 1, no_floor))[0].p > LEVEL


def test_strips_of_more_friction_have_no_name(tmp_path):
    diagnosis = diagnose(case(tmp_path, 1, strips))
    answer = diagnosis.answer()
    assert answer["effects"] == []
    assert answer["unexplained_where"] == {"channel": "wheel_speed_rad_s", "covariate": "position"}
    text = " ".join(" ".join(summary(report_data(diagnosis))).split())
    assert "wheel_left_rad_s and wheel_right_rad_s have structure along position (friction that depends on x" in text
    # Whichever way the robot drives, it is slower than predicted near a strip.
    place, residuals, holdout = shown_residuals(diagnosis, diagnosis.unexplained)
    assert len(place.values) == len(place.second) == len(residuals) == len(holdout)
    known = np.isfinite(residuals) & np.isfinite(place.values)
    near = (place.values[known] + 0.02) % 0.25 < 0.07
    assert np.mean(residuals[known][near]) < np.mean(residuals[known][~near]) - 0.5
