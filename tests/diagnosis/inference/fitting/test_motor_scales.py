"""The search for an effect begins at the same share of a motor's own sizes."""

import pytest

from diagnosis.inference.fitting.hypothesis import CandidateEffect
from physics.effects.driver_and_battery.bridge_voltage_drop import BridgeVoltageDrop
from physics.effects.driver_and_battery.current_limit import CurrentLimit
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.motor_and_gearbox.quadratic_drag import QuadraticDrag
from physics.effects.motor_and_gearbox.stribeck_friction import StribeckFriction
from sensors.effects.motor_bench.current_sensor_offset import CurrentSensorOffset


@pytest.fixture
def motor_of(robot):
    """A robot whose motor has multiples of the sizes of the paper's motor, at 7.4 V."""

    def make(resistance=1.0, constant=1.0, friction=1.0, supply=1.0):
        numbers = {
            "winding_resistance_ohm": 2.85 * resistance,
            "torque_constant_N_m_A": 0.31 * constant,
            "coulomb_friction_N_m": 0.0174 * friction,
        }
        changed = robot.with_section("motor", numbers)
        return changed.model_copy(update={"power": robot.power.model_copy(update={"battery_voltage_V": 7.4 * supply})})

    return make


def starts(robot, kind):
    candidate = CandidateEffect.on_top_of(robot, kind, ())
    return [float(c.value(c.start)) for c in candidate.coordinates]


def test_the_motor_of_the_paper_has_the_starts_of_the_effects(motor_of):
    assert starts(motor_of(), StribeckFriction) == pytest.approx([0.008, 2.0])
    assert starts(motor_of(), SupplySag) == pytest.approx([0.5])


@pytest.mark.parametrize(("sizes", "highest"), [({}, 50.0), ({"constant": 2.0}, 50.0), ({"constant": 0.1}, 500.0)])
def test_the_friction_of_a_fast_motor_may_fall_over_higher_speeds(motor_of, sizes, highest):
    """A motor with a tenth of the torque constant is ten times as fast."""
    _, speed = CandidateEffect.on_top_of(motor_of(**sizes), StribeckFriction, ()).coordinates
    assert float(speed.value(speed.high)) == pytest.approx(highest)


@pytest.mark.parametrize(
    ("kind", "sizes", "expected"),
    [
        (StribeckFriction, {"friction": 40.0, "supply": 2.0}, [0.32, 4.0]),
        (StribeckFriction, {"friction": 0.01}, [8e-5, 2.0]),
        (QuadraticDrag, {"friction": 2.0, "constant": 0.5}, [1e-4 * 2.0 / 4.0]),
        (BridgeVoltageDrop, {"supply": 3.0}, [0.9]),
        (SupplySag, {"resistance": 4.0}, [2.0]),
        # An offset is seen beside the current that overcomes friction, a limit beside that at standstill.
        (CurrentSensorOffset, {"friction": 3.0, "constant": 2.0}, [0.03 * 1.5]),
        (CurrentLimit, {"supply": 2.0, "resistance": 4.0}, [0.4]),
    ],
)
def test_starts_grow_with_the_motor(motor_of, kind, sizes, expected):
    assert starts(motor_of(**sizes), kind) == pytest.approx(expected)
