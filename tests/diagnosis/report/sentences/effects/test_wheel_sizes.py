"""The wheels of a fitted robot in millimetres."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import yaml

from configs.schema.robot import RobotConfig
from diagnosis.report.sentences.effects.wheel_sizes import wheel_sizes
from physics.effects.motor_and_gearbox.friction_asymmetry import FrictionAsymmetry
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry

NOMINAL = Path(__file__).parents[5] / "configs/robots/nominal.yaml"
DIAMETER_M, TRACK_M, ASYMMETRY = 0.1, 0.2, -0.03


def robot(x):
    """Return a robot by its diameter and track, as differences from the nominal ones, and its asymmetry."""
    nominal = RobotConfig.model_validate(yaml.safe_load(NOMINAL.read_text()))
    drive = nominal.drive.model_copy(update={"wheel_diameter_m": DIAMETER_M + x[0], "track_m": TRACK_M + x[1]})
    plain = nominal.model_copy(update={"drive": drive})
    return plain.with_effect(WheelRadiusAsymmetry(asymmetry=x[2])) if x[2] else plain


def sizes_of(effect, covariance):
    x = np.array([0.001, 0.002, ASYMMETRY])
    hypothesis = SimpleNamespace(robot=robot)
    fit = SimpleNamespace(hypothesis=hypothesis, x=x, robot=robot(x), covariance=covariance)
    diagnosis: Any = SimpleNamespace(fit=fit, nominal=robot(np.zeros(3)))
    named: Any = SimpleNamespace(effect=SimpleNamespace(kind=effect))
    return wheel_sizes(named, diagnosis)


def test_both_diameters_have_the_errors_of_their_mean_and_of_the_asymmetry():
    """Diameters d (1 +- a/2) with d = 101 mm and a = -0.03; errors of 0.1 mm and 0.002, that is 0.101 mm of each."""
    text = sizes_of(WheelRadiusAsymmetry, np.diag([1e-4, 2e-4, 2e-3]) ** 2)
    left_mm, right_mm = np.hypot(0.985 * 0.1, 50.5 * 0.002), np.hypot(1.015 * 0.1, 50.5 * 0.002)
    assert text == (
        f"left diameter 99.48 ± {left_mm:.2f} mm (nominal 100 mm), right diameter 102.52 ± {right_mm:.2f} mm "
        "(nominal 100 mm), track 202.00 ± 0.20 mm (nominal 200 mm)"
    )


def test_errors_that_belong_together_are_not_added_as_if_they_were_independent():
    """If the errors cancel for the left wheel, d must change by -50.5 / 0.985 mm for each unit of a."""
    direction = np.array([-0.0505 / 0.985, 0.0, 1.0]) * 0.002
    right_mm = (1.015 / 0.985 + 1.0) * 50.5 * 0.002
    assert f"right diameter 102.52 ± {right_mm:.2f} mm" in sizes_of(
        WheelRadiusAsymmetry, np.outer(direction, direction)
    )


def test_a_size_has_no_error_if_it_is_not_determined_and_the_others_keep_theirs():
    covariance = np.diag([1e-4, np.inf, 2e-3]) ** 2
    text = sizes_of(WheelRadiusAsymmetry, covariance)
    assert "left diameter 99.48 ± 0.14 mm" in text
    assert text.endswith("track 202 mm (nominal 200 mm)")


def test_other_effects_state_no_wheels():
    assert sizes_of(FrictionAsymmetry, np.eye(3)) == ""
