"""The torque constants of both motors of a fitted robot."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import yaml

from configs.schema.robot import RobotConfig
from diagnosis.report.sentences.effects.torque_constants import torque_constants
from physics.effects.motor_and_gearbox.rotor_inertia_scale import RotorInertiaScale
from physics.effects.motor_and_gearbox.torque_constant_mismatch import TorqueConstantMismatch
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.effects.motor_and_gearbox.winding_resistance_scale import WindingResistanceScale
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry

NOMINAL = Path(__file__).parents[5] / "configs/robots/nominal.yaml"


def robot(x):
    """Return a robot with K = 0.3 N m/A, times a scale, and a mismatch of its motors."""
    nominal = RobotConfig.model_validate(yaml.safe_load(NOMINAL.read_text()))
    plain = nominal.with_section("motor", {"torque_constant_N_m_A": 0.3}).with_effect(TorqueConstantScale(scale=x[0]))
    plain = plain.with_effect(RotorInertiaScale(scale=1.2)).with_effect(WindingResistanceScale(scale=1.1))
    return plain.with_effect(TorqueConstantMismatch(mismatch=x[1])) if x[1] else plain


def constants_of(mismatch, *effects):
    """Return the text beside each of the named effects."""
    x = np.array([1.05, mismatch])
    hypothesis = SimpleNamespace(robot=robot)
    covariance = np.diag([1e-3, 2e-3]) ** 2
    fit = SimpleNamespace(hypothesis=hypothesis, x=x, robot=robot(x), covariance=covariance)
    named: Any = [SimpleNamespace(effect=SimpleNamespace(kind=effect, choices=())) for effect in effects]
    diagnosis: Any = SimpleNamespace(fit=fit, nominal=robot(np.array([1.0, 0.0])), named=named)
    return [torque_constants(each, diagnosis) for each in named]


def test_both_constants_have_the_errors_of_their_mean_and_of_the_mismatch():
    """K s (1 +- m/2) with K = 0.3, s = 1.05 and m = 0.1: the errors of s and m are 0.001 and 0.002."""
    left = np.hypot(0.3 * 1.05 * 0.001, 0.3 * 1.05 * 0.5 * 0.002)
    right = np.hypot(0.3 * 0.95 * 0.001, 0.3 * 1.05 * 0.5 * 0.002)
    text = f"left 0.33075 ± {left:.5f} N m/A (nominal 0.3 N m/A), right 0.29925 ± {right:.5f} N m/A (nominal 0.3 N m/A)"
    assert constants_of(0.1, TorqueConstantMismatch) == [text]
    assert constants_of(0.1, TorqueConstantScale) == [text]
    assert constants_of(0.1, TorqueConstantMismatch, TorqueConstantScale) == [text, ""]


def test_equal_motors_and_effects_on_other_numbers_state_no_constants():
    assert constants_of(0.0, TorqueConstantScale) == [""]
    assert constants_of(0.1, WheelRadiusAsymmetry) == [""]
    texts = constants_of(0.1, RotorInertiaScale, WindingResistanceScale, TorqueConstantMismatch)
    assert texts[:2] == ["", ""]
    assert texts[2]
