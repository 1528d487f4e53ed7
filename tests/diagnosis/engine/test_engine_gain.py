"""Before and after by PyBullet, of benches and drives whose robot is known."""

from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.terms.drive import WheelRadiusScale
from configs.schema.terms.motor import TorqueConstantScale
from diagnosis.engine.base import by_pybullet, by_twin, without_body
from diagnosis.engine.gain import by_engines
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import Kind, Measurement, Source, Trial
from diagnosis.nominal_robot import nominal_robot
from physics.trajectory import TimeSeries


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 0, "test")[0]


def test_a_bench_of_a_weak_magnet_loses_its_error_in_pybullet_as_in_the_twin(motor_bench_case, robot, tmp_path):
    """The closed form's readings; noise of 1 mA and 0.04 rad/s is all that is left."""
    measured = read_measurement(motor_bench_case(tmp_path / "weak", strength=0.9), IMPORTERS)
    nominal = nominal_robot(measured.nominal, robot)
    found = by_engines(measured, nominal, nominal.with_term(TorqueConstantScale(scale=0.9)))
    bullet, twin = found.engines
    current, speed = bullet.errors
    assert current.before > 0.005
    assert current.after < 0.0015
    assert speed.before > 0.3
    assert speed.after < 0.06
    assert bullet.whole.value == pytest.approx(twin.whole.value, abs=0.01)
    assert bullet.whole.low <= bullet.whole.value <= bullet.whole.high


def drive_by(pose_and_counts, voltage):
    """A log of rows of 50 ms, the last third held out."""
    t_s = 0.05 * np.arange(len(voltage) + 1)
    columns = dict(zip(("x_m", "y_m", "theta_rad"), pose_and_counts.pose.T, strict=True))
    columns |= dict(zip(("enc_right_ticks", "enc_left_ticks"), pose_and_counts.counts.T, strict=True))
    columns |= {f"u_{side}_V": np.append(voltage[:, k], np.nan) for k, side in enumerate(("right", "left"))}
    channels = tuple(Channel.logged(TimeSeries(n, "", t_s, v.astype(float)), Role.READING) for n, v in columns.items())
    held = np.arange(len(t_s)) >= 2 * len(t_s) // 3
    trial = Trial("1", t_s, held, channels)
    return Measurement("made", Kind.DRIVE_LOG, Source("made", ()), (trial,))


def test_a_drive_of_the_twin_is_driven_again_by_the_robot_it_was_and_not_by_another(robot):
    smaller = robot.with_term(WheelRadiusScale(scale=0.95))
    voltage = np.stack([3.0 + np.sin(0.1 * np.arange(60)), 3.0 - np.sin(0.07 * np.arange(60))], axis=1)
    measured = drive_by(by_twin(smaller, voltage, 0.05), voltage)
    bullet, twin = by_engines(measured, robot, smaller).engines
    assert twin.errors[2].after == pytest.approx(0.0, abs=1e-9)
    ahead = bullet.errors[2]
    assert ahead.quantity == "pose_dx_m"
    assert ahead.after < 0.05 * ahead.before


def test_a_case_s_motor_with_the_body_in_its_numbers_is_as_quick_with_the_body_beside_it(robot):
    """Time to 63 %, with the whole inertia in the motor and none in the body, and by PyBullet with the body apart."""
    whole = robot.model_copy(update={"motor": robot.motor.model_copy(update={"rotor_inertia_kg_m2": 3e-3})})
    motor = whole.motor
    damping = motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm + motor.viscous_friction_N_m_s_rad
    turned = by_pybullet(without_body(whole), np.full((100, 2), 3.0), 0.01).counts[:, 0]
    speed = np.diff(turned).astype(float)
    reached_s = 0.01 * np.interp(0.632 * speed[-1], speed[:40], 0.5 + np.arange(40))
    assert reached_s == pytest.approx(3e-3 / damping, rel=0.05)


def test_what_cannot_be_driven_says_why(robot):
    found = by_engines(read_measurement(Path("table-3"), IMPORTERS), robot, robot)
    assert "nothing moves" in found.why_not
    assert found.engines == ()
