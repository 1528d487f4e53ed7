"""Laws of one wheel, sensor or wall, and laws over the floor: their files keep the rules, and stages predict them."""

from pathlib import Path

import numpy as np
import pytest

from diagnosis.case_robot import base_robot_of, nominal_of
from diagnosis.discovery.grammar import forms
from diagnosis.discovery.places import places
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.measurement import CaseKind
from diagnosis.predictors import STAGES
from diagnosis.predictors.rows import good_values, rows_after
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from pipeline.effects.contract import RULES, judged
from pipeline.effects.probe import Probe
from pipeline.effects.trial import trials

EXAMPLE = Path(__file__).parents[3] / "diagnosis" / "examples" / "drive_log_002"
NAMES = (
    "friction_disc_over_x_and_y",
    "friction_step_over_x",
    "left_friction_rise_over_time",
    "right_torque_triple_wave_over_angle",
    "travel_disc_over_x_and_y",
    "left_travel_step_over_time",
    "turning_step_over_time",
    "heading_double_wave_over_yaw",
    "heading_line_over_time",
    "front_range_memory_over_step",
    "right_range_bump_over_distance",
    "wall_facing_minus_y_range_offset",
)


@pytest.fixture(scope="module")
def case():
    """The nominal robot and the stages of the example."""
    measurement = read_measurement(EXAMPLE, IMPORTERS)
    robot = nominal_of(measurement, base_robot_of(measurement, None))
    return robot, {stage.name: stage for stage in STAGES[measurement.kind](measurement, robot)}


@pytest.fixture(scope="module")
def by_name(case):
    robot, stages = case
    where = places(CaseKind.DRIVE_LOG, Evidence(tuple(stages.values())), robot.motor)
    return {form.name: form for place in where for form in forms(place, ())}


def predicted(case, stage, *effects):
    """Predictions (N, n) of the quantities of a stage by the nominal robot with each of some effects."""
    robot, stages = case
    return np.swapaxes([each.mean for each in stages[stage].predict([robot.with_effect(e) for e in effects])], 0, 1)


@pytest.fixture(scope="module")
def probe():
    return Probe()


@pytest.mark.parametrize("name", NAMES)
def test_the_file_of_a_law_keeps_the_rules(by_name, probe, name):
    """The time of a jump is in the drive of the rules, where a step of 10 ms may see it."""
    form = by_name[name]
    (trial,) = trials(form.kind, probe, has_engine=False)
    rules = [rule for rule in RULES if rule.name != "settings"]
    assert [f"{verdict.rule.name}: {verdict.problem}" for verdict in judged(trial, rules) if verdict.problem] == []


def test_a_sensor_mixes_the_distance_of_the_row_before_into_its_reading(case, by_name):
    memory = by_name["front_range_memory_over_step"].kind
    bare, mixed = predicted(case, "tof", memory(share=0.0), memory(share=0.3))
    front = case[1]["tof"].observed[0]
    begins = np.diff(front.trial, prepend=-1) != 0
    before = np.where(begins, bare[0], np.roll(bare[0], 1))
    np.testing.assert_allclose(mixed[0], bare[0] + 0.3 * (before - bare[0]), atol=1e-12)
    np.testing.assert_array_equal(mixed[1:], bare[1:])


def test_one_wall_reads_too_far_for_all_sensors(case, by_name):
    wall = by_name["wall_facing_minus_y_range_offset"].kind
    bare, far = predicted(case, "tof", wall(offset_m=0.0), wall(offset_m=0.02))
    for k, observed in enumerate(case[1]["tof"].observed):
        (which,) = (each for each in observed.covariates if each.name == "wall")
        hits = which.values == which.labels.index("y = room_y_m")
        np.testing.assert_allclose(far[k] - bare[k], np.where(hits, 0.02, 0.0), atol=1e-12)


def test_travel_that_is_lost_everywhere_is_a_smaller_wheel(case, by_name):
    disc = by_name["travel_disc_over_x_and_y"].kind
    everywhere = disc(inside=-0.05, middle_x_m=1.0, middle_y_m=0.84, radius_m=1.35)
    lost, smaller = predicted(case, "pose", everywhere, WheelRadiusScale(scale=0.95))
    np.testing.assert_allclose(lost, smaller, atol=1e-9)


def test_a_robot_that_turns_less_from_the_beginning_has_a_wider_track(case, by_name):
    step = by_name["turning_step_over_time"].kind
    less, wider = predicted(case, "pose", step(step=-0.2, edge_s=0.0), WheelbaseScale(scale=1.25))
    np.testing.assert_allclose(less, wider, atol=1e-9)


def test_a_logged_turn_has_the_difference_of_the_errors_of_two_headings(case, by_name):
    """The error is a function of the true heading, which the logged one has beside a part of the error in it."""
    wave = by_name["heading_double_wave_over_yaw"].kind
    size, phase = 0.01, 0.4
    bare, swung = predicted(case, "pose", wave(swing_rad=0.0, phase_rad=phase), wave(swing_rad=size, phase_rad=phase))
    measurement = read_measurement(EXAMPLE, IMPORTERS)
    first, last = (good_values(measurement, "theta_rad")[rows] for rows in rows_after(measurement, 10, 5))
    error = size * (np.sin(2.0 * last + phase) - np.sin(2.0 * first + phase))
    known = np.isfinite(error)
    np.testing.assert_allclose((swung - bare)[2, known], error[known], atol=3.0 * size**2)
