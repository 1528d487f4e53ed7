"""Laws that are hidden in the ranges of a drive by their closed forms."""

import numpy as np
import pytest

from diagnosis.discovery.discover import with_law
from diagnosis.discovery.grammar import forms
from diagnosis.discovery.places import places
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement

ROOM_X_M, ROOM_Y_M, FRONT_M, SIDE_M = 2.0, 1.6, 0.06, 0.05
FAR_M, STEP_M, SD_M = 0.7, 0.008, 0.002
ROW_S, SWING_M, RATE_RAD_S = 0.09, 0.45, 0.7
FASTEST_M_S = SWING_M * RATE_RAD_S
EXTRA_M = 0.02
NOMINAL = f"""kind: drive_log
robot:
  wheel_radius_m: {{value: 0.035, tolerance: 0.0001}}
  wheel_separation_m: {{value: 0.15, tolerance: 0.0005}}
  encoder_ticks_per_revolution: 2000
tof:
  range_offset_m: {{value: 0.0, tolerance: 0.0005}}
  max_range_m: 1.2
  mount:
    front: {{x_m: {FRONT_M}, y_m: 0.0, yaw_rad: 0.0}}
    left: {{x_m: 0.0, y_m: {SIDE_M}, yaw_rad: {np.pi / 2.0}}}
    right: {{x_m: 0.0, y_m: -{SIDE_M}, yaw_rad: {-np.pi / 2.0}}}
world: {{room_x_m: {ROOM_X_M}, room_y_m: {ROOM_Y_M}}}
noise:
  pose_xy_m: 0.0002
  pose_theta_rad: 0.0005
  travel_m_per_sqrt_m: 0.0005
  wheel_speed_rad_s: 0.05
  tof_polynomial_mm: [{1000.0 * SD_M}, 0.0, 0.0, 0.0]
  tof_polynomial_origin_m: 0.18
"""


def step_beyond(far_m, _is_ahead):
    """Three sensors that read 8 mm too much beyond 0.7 m."""
    return far_m + np.where(far_m > FAR_M, STEP_M, 0.0)


def glass_at_the_end(far_m, is_ahead):
    """A wall at the far end of y that reads 20 mm too far: it is to the left of a robot that looks along +x."""
    return far_m + EXTRA_M * np.array([0.0, 1.0, 0.0] if is_ahead else [0.0, 0.0, 1.0])


def drive_along_the_room(folder, read=step_beyond, *, turns=False):
    """Return a log of a robot that drives to and fro along the room, each time nearer to one side. It looks along the
    x axis, so that the ranges are differences; in every second trial it looks the other way if it `turns`.
    """
    noise = np.random.Generator(np.random.PCG64(5))
    lines = ["trial,split,session_time_s,t_s,tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"]
    for trial in range(1, 7):
        y_m = 0.45 + 0.1 * trial
        is_ahead = not turns or trial % 2 == 1
        for row in range(50):
            t_s = ROW_S * row
            x_m = 1.3 + SWING_M * np.sin(RATE_RAD_S * t_s + trial)
            to_left_m, to_right_m = ROOM_Y_M - y_m, y_m
            far_m = np.array([ROOM_X_M - x_m, to_left_m, to_right_m] if is_ahead else [x_m, to_right_m, to_left_m])
            far_m -= np.array([FRONT_M, SIDE_M, SIDE_M])
            read_m = read(far_m, is_ahead) + SD_M * noise.standard_normal(3)
            yaw_rad = 0.0 if is_ahead else np.pi
            pose = np.array([x_m, y_m, yaw_rad]) + np.array([2e-4, 2e-4, 5e-4]) * noise.standard_normal(3)
            cells = ",".join(f"{value:.5f}" for value in (*read_m, *pose))
            split = "holdout" if trial % 3 == 0 else "fit"
            lines.append(f"{trial},{split},{100.0 * trial + t_s:.2f},{t_s:.2f},{cells}")
    (folder / "nominal.yaml").write_text(NOMINAL)
    (folder / "data.csv").write_text("\n".join(lines) + "\n")
    return read_measurement(folder, IMPORTERS)


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory, diagnosed_among):
    return with_law(diagnosed_among(drive_along_the_room(tmp_path_factory.mktemp("drive"))))


def test_a_step_of_all_ranges_is_found_at_its_distance(diagnosis):
    law = diagnosis.law
    assert law.name == "range_step_over_distance"
    assert law.values["step_m"] == pytest.approx(STEP_M, abs=3.0 * law.std["step_m"])
    assert law.values["edge_m"] == pytest.approx(FAR_M, abs=FASTEST_M_S * ROW_S)
    assert law.gain.after < 1.1 < law.gain.before
    assert law.ranges[0].covariate == "distance_m"
    assert (law.ranges[0].low, law.ranges[0].high) == pytest.approx((0.19, 1.09), abs=0.02)


def test_its_file_acts_in_drives(diagnosis):
    text = diagnosis.law.form.text()
    assert "setups = (Setup.DRIVE,)" in text
    assert "slot = Slot.RANGE" in text


def test_only_jumps_and_drifts_depend_on_the_time_of_a_drive(diagnosis):
    """A bump or a wave in time may be a place that the robot passes again and again."""
    where = places(diagnosis.measurement.kind, diagnosis.evidence, diagnosis.fit.robot.motor)
    place = next(each for each in where if each.name == "range")
    over_time = {form.shape for form in forms(place, ()) if form.covariates[0] == "session_time_s"}
    assert over_time == {"step", "rise", "line", "power", "saturation"}


def test_a_wall_that_reads_too_far_is_found_by_the_direction_that_it_faces(tmp_path, diagnosed_among):
    law = with_law(diagnosed_among(drive_along_the_room(tmp_path, glass_at_the_end, turns=True))).law
    assert law.name == "wall_facing_minus_y_range_offset"
    assert law.values["offset_m"] == pytest.approx(EXTRA_M, abs=3.0 * law.std["offset_m"])
