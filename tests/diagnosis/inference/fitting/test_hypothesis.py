from dataclasses import replace

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.scan import tried_values
from physics.effects.driver_and_battery.current_limit import CurrentLimit
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_scale import RangeScale
from sensors.effects.range_sensor.tof_mount_yaw import TofMountYaw


@pytest.mark.parametrize(
    ("present", "number", "total"),
    [
        (RangeOffset(offset_m=0.03), {"offset_m": 0.02}, 0.05),
        (RangeScale(scale=1.04), {"scale": 1.05}, 1.092),
    ],
)
def test_an_effect_comes_on_top_of_what_the_nominal_robot_has_of_that_name(robot, effect, present, number, total):
    changed = effect(present.name).on(robot.with_effect(present), number)
    (value,) = dict(changed.effects.get(type(present))).values()
    assert value == pytest.approx(total)


@pytest.mark.parametrize("kind", EFFECTS.classes(), ids=lambda kind: kind.name)
def test_without_a_change_the_nominal_robot_keeps_its_own_effect(robot, hypothesis, kind):
    choices = {name: (options or ("white_wall",))[0] for name, options in kind.options().items()}
    equipped = robot.with_effect(kind.start(choices))
    candidate = CandidateEffect.on_top_of(equipped, kind, tuple(choices.items()))
    model = replace(hypothesis, nominal=equipped).with_effect(candidate)
    (left,) = model.robot(model.null()).effects
    assert left.model_dump() == pytest.approx(kind.start(choices).model_dump())


def test_what_gives_an_effect_of_the_nominal_robot_its_shape_is_not_fitted(robot):
    sloping = robot.with_effect(FloorSlope(gradient=0.1, direction_rad=2.0, on_the_spot=0.4))
    candidate = CandidateEffect.on_top_of(sloping, FloorSlope, ())
    assert [coordinate.name for coordinate in candidate.coordinates] == ["gradient"]
    assert candidate.known == {"direction_rad": 2.0, "on_the_spot": 0.4}
    (slope,) = candidate.on(sloping, {"gradient": 0.03}).effects
    assert slope.model_dump() == pytest.approx({"gradient": 0.13, "direction_rad": 2.0, "on_the_spot": 0.4})


def test_a_robot_that_has_an_effect_of_one_sensor_cannot_have_it_of_another_too(robot):
    turned = robot.with_effect(TofMountYaw(sensor="left", angle_rad=0.1))
    assert CandidateEffect.on_top_of(turned, TofMountYaw, (("sensor", "front"),)) is None
    with pytest.raises(ValueError, match=r"tof_mount_yaw\[front\]: the nominal robot has tof_mount_yaw\[left\]"):
        CandidateEffect(TofMountYaw, (("sensor", "front"),)).on(turned, {"angle_rad": 0.0})


def test_a_limit_beside_that_of_the_nominal_robot_is_the_lower_one(robot, effect):
    limited = robot.with_effect(CurrentLimit(limit_A=0.6))
    for limit, total in ((0.5, 0.5), (0.9, 0.6)):
        (left,) = effect("current_limit").on(limited, {"limit_A": limit}).effects
        assert left.limit_A == total


def test_a_nuisance_goes_by_its_logarithm_and_a_small_deviation_is_its_tolerance(hypothesis):
    (nuisance,) = hypothesis.nuisances
    constants = [hypothesis.robot(np.array([x])).motor.torque_constant_N_m_A for x in (-1e-3, 0.0, 1e-3, 10.0, 20.0)]
    assert (constants[2] - constants[0]) / 2e-3 == pytest.approx(nuisance.tolerance, rel=1e-6)
    assert constants[4] / constants[3] == pytest.approx(constants[3] / constants[1])


def test_a_number_that_no_measurement_shows_is_not_fitted(robot, effect):
    """Means of a chopped current show only the product of inductance and switching frequency."""
    coast = effect("bridge_coast")
    assert [coordinate.name for coordinate in coast.coordinates] == ["inductance_H", "diode_V"]
    assert coast.known == {"switching_Hz": 20_000.0}
    (fitted,) = coast.on(robot, {"inductance_H": 2e-4, "diode_V": 1.1}).effects
    assert fitted.model_dump() == {"inductance_H": 2e-4, "diode_V": 1.1, "switching_Hz": 20_000.0}


def test_cycles_per_turn_are_fitted_as_they_are(effect):
    """A step of a derivative is then the same phase at the end of a log for slow and fast waves."""
    _, cycles, _ = effect("torque_ripple").coordinates
    assert [cycles.value(x) for x in (0.5, 30.0)] == [0.5, 30.0]
    assert cycles.null is None


def test_a_phase_is_fitted_as_it_is_and_tried_all_around(effect):
    """In contrast to a time constant, whose logarithm is fitted; 30 degrees off, 87 % of an effect are left."""
    amplitude, phase = effect("wheel_eccentricity").coordinates
    assert [phase.value(x) for x in (-2.0, 0.0, 2.0)] == [-2.0, 0.0, 2.0]
    assert phase.null is None
    tried = np.exp(1j * np.array(tried_values(phase)))
    for angle in np.linspace(-np.pi, np.pi, 50):
        assert np.max((tried * np.exp(-1j * angle)).real) > np.cos(np.radians(30.1))
    assert min(tried_values(amplitude)) > amplitude.null
