"""Floors and casters that no effect describes: the robot is moved here, by the mid-point rule."""

from math import pi

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers.drive_log import IMPORTER

RADIUS_M, TRACK_M, TICKS, ROW_S, ROWS = 0.03, 0.15, 2048, 0.05, 500
XY_M, THETA_RAD, SLIP = 0.001, 0.003, 0.0005
NOMINAL = f"""kind: drive_log
robot:
  wheel_radius_m: {{value: {RADIUS_M}, tolerance: 0.00003}}
  wheel_separation_m: {{value: {TRACK_M}, tolerance: 0.0006}}
  encoder_ticks_per_revolution: {TICKS}
noise: {{wheel_speed_rad_s: 0.05, pose_xy_m: {XY_M}, pose_theta_rad: {THETA_RAD}, travel_m_per_sqrt_m: {SLIP},
  tof_polynomial_mm: [1, 0, 0, 0], tof_polynomial_origin_m: 0.18}}
"""
HEADER = (
    "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks,"
    "tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"
)


def drive(rng, lost_at, kick_rad, swing=None):
    """Rows of counts and poses of a drive about (1, 1).

    A share `lost_at` of each motion is lost at a place. The robot is kicked when it starts to turn the other way. With
    a `swing`, it turns on the spot again and again, and whenever it drives on, by so many rad over so many metres.
    """
    pose, angle, rows, speed, turn = np.array([1.0, 1.0, rng.uniform(-pi, pi)]), np.zeros(2), [], 0.0, 0.0
    side, since_m = 0.0, np.inf
    for k in range(ROWS):
        rows.append([*np.floor(angle * TICKS / (2.0 * pi)), *(pose + [XY_M, XY_M, THETA_RAD] * rng.standard_normal(3))])
        if k % 30 == 0:
            home = np.arctan2(1.0 - pose[1], 1.0 - pose[0]) - pose[2]
            far = np.hypot(*(pose[:2] - 1.0)) > 0.5
            speed = rng.uniform(0.1, 0.4)
            turn = np.arctan2(np.sin(home), np.cos(home)) / 1.5 if far else rng.uniform(-1.5, 1.5)
        if swing is not None and k % 10 == 0:
            goes_on = k % 20 == 10
            speed = rng.uniform(0.1, 0.3) * (-1.0 if rng.random() < 0.3 else 1.0) if goes_on else 0.0
            turn, since_m = rng.uniform(-0.5, 0.5) if goes_on else rng.uniform(-4.0, 4.0), 0.0
        travel = ROW_S * np.array([speed - 0.5 * TRACK_M * turn, speed + 0.5 * TRACK_M * turn])
        angle = angle + travel / RADIUS_M
        travel = (1.0 - lost_at(*pose[:2])) * travel + SLIP * np.sqrt(np.abs(travel)) * rng.standard_normal(2)
        spun = (travel[1] - travel[0]) / TRACK_M
        spun += kick_rad * np.sign(turn) if np.sign(turn) * side < 0.0 else 0.0
        side = np.sign(turn)
        if swing is not None:
            angle_rad, over_m = swing
            inside_m = min(max(over_m - since_m, 0.0), ROW_S * abs(speed))
            spun += angle_rad / over_m * np.copysign(inside_m, speed)
            since_m += ROW_S * abs(speed)
        heading = pose[2] + 0.5 * spun
        pose = pose + np.array([travel.mean() * np.cos(heading), travel.mean() * np.sin(heading), spun])
    return rows


def diagnosed(folder, lost_at, kick_rad=0.0, swing=None):
    lines, rng = [HEADER], np.random.default_rng(7)
    for trial in range(4):
        for k, (left, right, x, y, theta) in enumerate(drive(rng, lost_at, kick_rad, swing)):
            t, split = k * ROW_S, "holdout" if trial == 3 else "fit"
            cells = [trial, split, f"{40.0 * trial + t:.2f}", f"{t:.2f}", 0.2, 0.0, "", "", int(left), int(right)]
            lines.append(",".join(map(str, [*cells, "", "", "", f"{x:.4f}", f"{y:.4f}", f"{theta:.4f}"])))
    (folder / "nominal.yaml").write_text(NOMINAL, encoding="utf-8")
    (folder / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return diagnose(IMPORTER.read(folder)).answer()


@pytest.mark.parametrize(("at", "radius_m", "share"), [((1.1, 0.9), 0.5, 0.02), ((1.0, 1.0), 0.35, 0.01)])
def test_a_patch_is_a_matter_of_the_place_and_no_effect_of_the_wheels(tmp_path, at, radius_m, share):
    """The robot spends much of its time there, so that a smaller radius explains most of what is lost."""
    answer = diagnosed(tmp_path, lambda x, y: share * (np.hypot(x - at[0], y - at[1]) < radius_m))
    assert answer["effects"] == []
    assert answer["unexplained_where"] == {"channel": "pose_increment", "covariate": "position"}


def test_a_share_that_is_lost_everywhere_is_a_radius(tmp_path):
    answer = diagnosed(tmp_path, lambda _x, _y: 0.03)
    (effect,) = answer["effects"]
    assert effect["name"] == "wheel_radius_scale"
    assert effect["parameters"]["scale"] == pytest.approx(0.97, abs=3.0 * effect["std"]["scale"])
    assert not answer["unexplained"]


@pytest.mark.parametrize("kick_rad", [0.02, pytest.param(-0.02, marks=pytest.mark.long), 0.2])
def test_a_caster_that_kicks_at_each_reversal_of_the_turn_is_no_effect_of_the_wheels(tmp_path, kick_rad):
    """Single rows that are far off count little, and those of both directions cancel each other in any mean."""
    answer = diagnosed(tmp_path, lambda _x, _y: 0.0, kick_rad)
    assert answer["effects"] == []
    assert answer["unexplained_where"] == {"channel": "pose_increment", "covariate": "turn_reversal_rad_s"}


@pytest.mark.parametrize("swing", [(0.03, 0.03), pytest.param((-0.04, 0.05), marks=pytest.mark.long)])
def test_a_caster_that_swings_round_whenever_the_robot_drives_on_is_no_difference_of_the_wheels(tmp_path, swing):
    """It turns the robot while it drives, as wheels of different size do, but only at first."""
    answer = diagnosed(tmp_path, lambda _x, _y: 0.0, swing=swing)
    assert answer["effects"] == []
    assert answer["unexplained_where"] == {"channel": "pose_increment", "covariate": "distance_since_start_m"}


def test_turns_on_the_spot_without_a_swing_are_explained(tmp_path):
    answer = diagnosed(tmp_path, lambda _x, _y: 0.0, swing=(0.0, 1.0))
    assert answer["effects"] == []
    assert not answer["unexplained"]
