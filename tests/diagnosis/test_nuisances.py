"""What may differ between units, as nominal.yaml of the examples says it."""

import numpy as np
import pytest
import yaml

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.examples.example import FOLDER as EXAMPLES
from diagnosis.measured.case_files.nominal import read_nominal
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import creep_on_the_spot, nuisances, with_values
from diagnosis.usual_tolerances import usual_wheels
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_scale import RangeScale

OF_NO_SOURCE = {"command_timing_s", "creep_on_the_spot"}
MOTOR = {"winding_resistance_ohm", "torque_constant_N_m_A", "viscous_friction_N_m_s_rad", "coulomb_friction_N_m"}
NAMES = {
    "motor_steady_001": MOTOR,
    "motor_step_001": MOTOR | {"rotor_inertia_kg_m2"},
    "tof_bench_001": {"range_offset_m", "range_scale"},
    "drive_log_001": MOTOR
    | {"rotor_inertia_kg_m2", "wheel_radius_m", "wheel_separation_m", "range_offset_m"}
    | OF_NO_SOURCE,
}


def spreads(tree):
    """Every mapping of value and tolerance in a YAML tree, by its key."""
    for key, below in tree.items():
        if isinstance(below, dict):
            if set(below) == {"value", "tolerance"}:
                yield key, (below["value"], below["tolerance"])
            else:
                yield from spreads(below)


@pytest.fixture(scope="module")
def base_robot():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


@pytest.mark.parametrize("case", NAMES)
def test_every_number_with_a_tolerance_is_one_and_the_nominal_robot_has_its_value(case, base_robot):
    path = EXAMPLES / case / "nominal.yaml"
    nominal = read_nominal(path)
    all_nuisances = nuisances(nominal)
    by_case = [of for of in all_nuisances if of.name not in OF_NO_SOURCE]
    assert {of.name: (of.value, of.tolerance) for of in by_case} == dict(spreads(yaml.safe_load(path.read_text())))
    assert {of.name for of in all_nuisances} == NAMES[case]
    robot = nominal_robot(nominal, base_robot)
    for of in all_nuisances:
        if not of.name.startswith(("range", "command")):
            assert of.change_robot(robot, of.value) == robot


@pytest.mark.parametrize("case", NAMES)
def test_several_in_one_step_are_the_same_as_one_after_the_other(case, base_robot):
    nominal = read_nominal(EXAMPLES / case / "nominal.yaml")
    values = [(of, of.value + number * of.tolerance) for number, of in enumerate(nuisances(nominal), 1)]
    one_by_one = robot = nominal_robot(nominal, base_robot)
    for of, value in values:
        one_by_one = of.change_robot(one_by_one, value)
    assert with_values(robot, values) == one_by_one != robot


def test_they_change_motor_and_geometry_of_the_robot(base_robot):
    nominal = read_nominal(EXAMPLES / "drive_log_001" / "nominal.yaml")
    robot = nominal_robot(nominal, base_robot)
    by_name = {of.name: of for of in nuisances(nominal)}
    assert by_name["coulomb_friction_N_m"].change_robot(robot, 0.03).motor.coulomb_friction_N_m == 0.03
    assert by_name["wheel_radius_m"].change_robot(robot, 0.04).drive.wheel_diameter_m == 0.08
    assert by_name["wheel_separation_m"].change_robot(robot, 0.2).drive.track_m == 0.2
    many = by_name["wheel_separation_m"].change_robot(robot, np.array([0.2, 0.3]))
    assert many.drive.track_m.tolist() == [0.2, 0.3]


def test_how_a_robot_creeps_on_the_spot_is_a_number_of_a_sloping_floor_alone(base_robot):
    """Between a creep by the way of the middle of the axle, and one by the rolling of the wheels."""
    spot = creep_on_the_spot()
    assert spot.change_robot(base_robot, 0.5) == base_robot
    sloping = base_robot.with_effect(FloorSlope(gradient=0.1, direction_rad=2.0, on_the_spot=0.8))
    assert spot.change_robot(sloping, spot.value) == sloping
    assert spot.change_robot(sloping, 0.5).effects.get(FloorSlope).on_the_spot == 0.4
    assert [spot.value + spot.tolerance * bound for bound in spot.bounds] == [0.0, 1.0]


def test_the_nominal_robot_of_a_drive_has_the_numbers_of_the_case(base_robot):
    nominal = read_nominal(EXAMPLES / "drive_log_001" / "nominal.yaml")
    robot = nominal_robot(nominal, base_robot)
    assert robot.drive.wheel_diameter_m == pytest.approx(2 * 0.03038)
    assert (robot.drive.track_m, robot.encoder.counts_per_revolution) == (0.1604, 1920)
    assert (robot.motor.rotor_inertia_kg_m2, robot.power.battery_voltage_V) == (0.002991, 7.4)
    left = robot.tof.mounts.left
    assert (left.x_m, left.y_m, left.yaw_deg) == (0.045, 0.05, pytest.approx(45.0))
    assert (robot.tof.max_range_m, robot.tof.error_scale, robot.tof.rays) == (1.2, 0.0, 1)
    assert robot.model_dump()["effects"] == {}


def test_an_effect_of_the_same_kind_stays_on_top_of_the_units_own_offset_and_scale(base_robot):
    nominal = read_nominal(EXAMPLES / "tof_bench_001" / "nominal.yaml")
    robot = (
        nominal_robot(nominal, base_robot).with_effect(RangeOffset(offset_m=0.02)).with_effect(RangeScale(scale=1.1))
    )
    offset, scale = nuisances(nominal)
    changed = scale.change_robot(offset.change_robot(robot, 0.001), 0.99).effects
    assert changed.get(RangeOffset).offset_m == pytest.approx(0.021)
    assert changed.get(RangeScale).scale == pytest.approx(1.1 * 0.99)


def test_of_drawn_wheels_both_may_differ_and_nothing_else(base_robot):
    """A radius of 40 mm, 200 mm apart, 2000 counts; the left wheel 0.2 % above the mean, the right one below."""
    known = usual_wheels(diameter_m=0.08, track_m=0.2, counts_per_turn=2000)
    robot = nominal_robot(known, base_robot)
    assert (robot.drive.wheel_diameter_m, robot.drive.track_m) == (0.08, 0.2)
    assert robot.encoder.counts_per_revolution == 2000
    assert robot.motor == base_robot.motor
    found = {nuisance.name: nuisance for nuisance in nuisances(known)}
    assert set(found) == {"wheel_radius_m", "wheel_separation_m", "wheel_radius_asymmetry"}
    uneven = found["wheel_radius_asymmetry"].change_robot(robot, 0.004)
    assert uneven.effects.get(WheelRadiusAsymmetry).asymmetry == 0.004
    twice = found["wheel_radius_asymmetry"].change_robot(uneven, 0.001)
    assert twice.effects.get(WheelRadiusAsymmetry).asymmetry == pytest.approx(0.005)
