"""The robot files of a diagnosis: what they say is what was fitted, and what no drive can have stays out."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.diagnose import diagnose
from diagnosis.examples.example import FOLDER as EXAMPLES
from diagnosis.extended_robot import FILE, _comments, extended_robot, rounded
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.fitting.likelihood import stated_noise
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.rivals import RivalComparison
from diagnosis.measured.case_files.nominal import read_nominal
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from physics.drivetrain.motor_bench import steady_states
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.robot.model import RobotModel
from sensors.effects.range_sensor.range_saturation import RangeSaturation


@pytest.fixture
def loaded(tmp_path):
    """The robot of the file."""

    def load(robot):
        (tmp_path / FILE).write_text(robot.text)
        return draw_robot(load_section("robot", str(tmp_path / FILE)), 0, "test")[0]

    return load


def with_effect(diagnosis, name, choices=(), **values):
    """The diagnosis as if it had named this effect and nothing else."""
    effect = CandidateEffect(EFFECTS.by_name()[name], choices)
    hypothesis = Hypothesis(diagnosis.nominal, (), (effect,))
    x = np.array([c.coordinate(values[c.name]) for c in effect.coordinates])
    nothing = np.zeros((len(x), len(diagnosis.evidence.values)))
    evidence = diagnosis.evidence
    noise, sd, information = stated_noise(evidence), nothing[0] + 1.0, 1e4 * np.eye(len(x))
    fit = HypothesisFit(
        evidence, hypothesis, x, 0.0, nothing[0], nothing[0] > 0.0, sd, noise, nothing, nothing, information
    )
    named = NamedEffect(effect, dict(hypothesis.values(effect, x)), fit.std(effect), RivalComparison(effect, 0.9, ()))
    return replace(diagnosis, fit=fit, named=(named,))


def test_the_file_reads_back_as_the_robot_that_was_fitted(diagnosis_of, loaded):
    diagnosis = diagnosis_of("weak")
    robot = extended_robot(diagnosis)
    reloaded = loaded(robot)
    assert reloaded == robot.config
    assert reloaded.motor.winding_resistance_ohm == pytest.approx(
        diagnosis.extended.motor.winding_resistance_ohm, rel=1e-6
    )
    assert reloaded.effects.get(TorqueConstantScale).scale == pytest.approx(
        diagnosis.named[0].values["scale"], rel=1e-6
    )


def test_an_effect_of_ones_own_is_named_with_its_file(diagnosis_of, loaded, tmp_path):
    file = Path(__file__).parents[3] / "examples/oval_wheel.py"
    EFFECTS.load(file)
    try:
        robot = extended_robot(with_effect(diagnosis_of("weak"), "oval_wheel", amplitude=0.02))
        EFFECTS.unload(file)
        assert 'effect_files:\n  - "oval_wheel.py"' in robot.text
        (kept,) = robot.config.effect_files
        (tmp_path / kept.file).write_text(kept.text)
        reloaded = loaded(robot)  # loads the copy beside the robot's file
        assert reloaded.effects.members[-1].amplitude == 0.02
        assert reloaded.effect_files == robot.config.effect_files
        assert kept.text == file.read_text()
    finally:
        for one in [*EFFECTS.files.values()]:
            EFFECTS.unload(one.path)


def test_the_robot_of_the_file_turns_as_the_real_one(diagnosis_of, loaded):
    """A weaker magnet runs faster off load: (K u / R - Tc) / (K^2 / R + B) with the real K of 0.27."""
    model = RobotModel.from_config(loaded(extended_robot(diagnosis_of("weak"))))
    _, speed = steady_states(model, np.array([2.0, 5.0]), np.zeros(2))
    expected = [(0.27 * volts / 3.0 - 0.02) / (0.27**2 / 3.0 + 0.002) for volts in (2.0, 5.0)]
    np.testing.assert_allclose(speed, expected, atol=0.04)


def test_each_number_says_where_it_comes_from(diagnosis_of):
    text = extended_robot(diagnosis_of("weak")).text
    for line in text.splitlines():
        if line.startswith(" ") and not line.endswith(":"):
            assert "  # " in line, line
    assert "# named by the diagnosis; standard error 0.006" in text
    assert "nominal 3, tolerance 0.03; fitted " in text


def test_the_standard_error_of_a_diameter_is_twice_that_of_the_radius():
    nominal = read_nominal(EXAMPLES / "drive_log_001" / "nominal.yaml")
    (radius,) = (each for each in nuisances(nominal) if each.name == "wheel_radius_m")
    robot = nominal_robot(nominal, draw_robot(load_section("robot", "nominal"), 0, "test")[0])
    hypothesis = SimpleNamespace(nominal=robot, nuisances=(radius,))
    fit = SimpleNamespace(hypothesis=hypothesis, x=np.zeros(1), covariance=np.array([[0.25]]))
    diagnosis: Any = SimpleNamespace(fit=fit, fitted_effects=(), random_drift=None, law=None)
    comment = _comments(diagnosis)["drive", "wheel_diameter_m"]
    # Half a tolerance of the radius is a whole one of the diameter.
    assert comment.endswith(f"standard error {radius.tolerance:.2g}")


def test_a_diagnosis_without_effects_has_a_robot_without_effects(diagnosis_of, loaded):
    assert loaded(extended_robot(diagnosis_of("plain"))).effects.members == ()


@pytest.mark.parametrize(
    ("name", "choices", "values", "why"),
    [
        ("gear_backlash", (), {"gap_rad": 0.05}, "one mass"),
        ("material_bias", (("material", "felt"),), {"offset_m": 0.01}, "no such surface"),
    ],
)
def test_what_no_drive_can_have_is_left_out_and_said(diagnosis_of, loaded, name, choices, values, why):
    robot = extended_robot(with_effect(diagnosis_of("plain"), name, choices, **values))
    assert [gone.name for gone in robot.left_out] == [name]
    assert why in robot.left_out[0].why
    assert f"# LEFT OUT, since no drive can simulate it: {name} (" in robot.text
    assert name not in [effect.name for effect in loaded(robot).effects]


def test_a_number_at_its_bound_is_within_it_when_read_back(diagnosis_of, loaded):
    """exp(log(100)) is 100.00000000000004, and a saturation at 100 m the highest."""
    robot = extended_robot(with_effect(diagnosis_of("plain"), "range_saturation", saturation_m=100.0))
    assert math.exp(math.log(100.0)) > 100.0
    assert loaded(robot).effects.get(RangeSaturation).saturation_m == 100.0


def test_a_robot_that_cannot_turn_is_said_to_be_none(diagnosis_of):
    robot = extended_robot(with_effect(diagnosis_of("plain"), "viscous_friction_scale", scale=2.0))
    assert robot.problem == ""
    stuck = diagnosis_of("plain")
    motor = stuck.nominal.motor.model_copy(update={"coulomb_friction_N_m": 5.0})
    bad = replace(stuck, nominal=stuck.nominal.model_copy(update={"motor": motor}))
    extended = extended_robot(with_effect(bad, "viscous_friction_scale", scale=2.0))
    assert "cannot overcome its friction" in extended.problem
    assert "# THIS ROBOT CANNOT DRIVE YET: robot.motor.coulomb_friction_N_m" in extended.text


def test_friction_that_was_fitted_below_zero_is_none(diagnosis_of, loaded):
    plain = diagnosis_of("plain")
    motor = plain.nominal.motor.model_copy(update={"viscous_friction_N_m_s_rad": -0.003})
    below = replace(plain, nominal=plain.nominal.model_copy(update={"motor": motor}))
    robot = extended_robot(with_effect(below, "speed_scale", scale=1.1))
    assert loaded(robot).motor.viscous_friction_N_m_s_rad == 0.0
    assert "viscous_friction_N_m_s_rad: 0.0  # moved to its bound; the fitted value is -0.003" in robot.text


def test_counts_that_are_no_whole_number_are_rounded_and_said():
    """43.7 to 1 and 64 counts of the motor make 2796.8 of the wheel; the simulator counts whole ones."""
    nominal, _ = draw_robot(load_section("robot", "nominal"), 1, "test")
    encoder = nominal.encoder.model_copy(update={"counts_per_revolution": 2796.8})
    config, moved = rounded(nominal.model_copy(update={"encoder": encoder}), nominal)
    assert config.encoder.counts_per_revolution == 2797
    assert moved == {("encoder", "counts_per_revolution"): "the nearest integer to 2796.8"}


def test_the_body_is_as_wide_as_its_wheels_stand_apart(diagnosis_of, loaded):
    """A case tells the wheels' distance alone; the shipped robot is 0.17 m wide, its wheels 0.02 m."""
    plain = diagnosis_of("plain")
    apart = plain.nominal.model_copy(update={"drive": plain.nominal.drive.model_copy(update={"track_m": 0.2})})
    robot = extended_robot(with_effect(replace(plain, nominal=apart), "wheelbase_scale", scale=1.02))
    assert robot.problem == ""
    assert loaded(robot).chassis.width_m == pytest.approx(0.22, abs=1e-3)
    assert "width_m: 0.22  # widened to cover the wheels" in robot.text


@pytest.mark.parametrize("name", ["a b/c", "<b>", "...", "x" * 200])
def test_any_name_of_a_case_makes_a_robot_that_loads(diagnosis_of, loaded, name):
    diagnosis = diagnosis_of("plain")
    named = replace(diagnosis, measurement=replace(diagnosis.measurement, name=name))
    assert loaded(extended_robot(named)).motor == extended_robot(diagnosis).config.motor


def test_another_nominal_robot_stands_in_for_what_a_case_does_not_tell(motor_bench_case, tmp_path, loaded):
    """Its body and controller stay; the motor is that of the case."""
    classroom, _ = draw_robot(load_section("robot", "classroom"), 0, "test")
    other = classroom.model_copy(update={"drive": classroom.drive.model_copy(update={"caster_friction": 0.05})})
    measured = read_measurement(motor_bench_case(tmp_path / "plain"), IMPORTERS)
    reloaded = loaded(extended_robot(diagnose(measured, other)))
    assert reloaded.drive.caster_friction == 0.05
    assert reloaded.motor.winding_resistance_ohm == pytest.approx(3.0, rel=0.03)
    assert reloaded.controller == other.controller
