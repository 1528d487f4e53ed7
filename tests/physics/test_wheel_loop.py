import math

import pytest

from physics.drivetrain.motor import MotorModel
from physics.drivetrain.wheel_loop import WheelSpeedLoop, voltage_limit_V

RATE_HZ = 100
LOAD_KG_M2 = 0.5 * 1.0 * 0.0325**2
"""Half the robot's mass at the wheel's radius."""


class Bench:
    """A loop on the engine-free motor, with half the robot as its load."""

    def __init__(self, robot, load=LOAD_KG_M2):
        self.motor = MotorModel.from_config(robot.motor)
        self.loop = WheelSpeedLoop(robot.wheel_loop, robot.encoder, robot.power, RATE_HZ)
        self.counts_per_rad = robot.encoder.counts_per_revolution / (2 * math.pi)
        self.load = load
        self.angle = self.speed = 0.0
        self.voltages = []
        self.speeds = []

    def run(self, set_point, seconds):
        for _ in range(round(seconds * RATE_HZ)):
            voltage = self.loop.update(math.floor(self.angle * self.counts_per_rad + 0.5), set_point)
            self.speed, turned = self.motor.step(voltage, self.speed, 1 / RATE_HZ, self.load)
            self.angle += turned
            self.voltages.append(voltage)
            self.speeds.append(self.speed)
        return self


@pytest.mark.parametrize("set_point", [-9.0, -4.6, 2.0, 4.6, 9.0])
def test_the_loop_reaches_its_set_point_within_0_3_s_without_much_overshoot(robot, set_point):
    bench = Bench(robot).run(set_point, 1.0)
    shares = [speed / set_point for speed in bench.speeds]
    assert max(shares) < 1.15
    assert all(abs(share - 1.0) < 0.02 for share in shares[30:])


def test_the_loop_holds_its_speed_against_another_load(robot):
    bench = Bench(robot, load=3 * LOAD_KG_M2).run(5.0, 2.0)
    assert bench.speeds[-1] == pytest.approx(5.0, rel=0.02)


def test_the_output_stays_within_the_lower_of_battery_and_driver_limit(robot):
    assert voltage_limit_V(robot.power) == 6.0
    weak = robot.power.model_copy(update={"battery_voltage_V": 3.3})
    assert voltage_limit_V(weak) == 3.3
    bench = Bench(robot.model_copy(update={"power": weak})).run(30.0, 1.0)
    assert max(bench.voltages) == 3.3


def test_a_set_point_beyond_reach_leaves_no_wind_up(robot):
    bench = Bench(robot).run(100.0, 5.0).run(4.6, 0.4)
    assert bench.speed == pytest.approx(4.6, rel=0.02)


def test_a_stop_ends_at_rest_with_no_voltage(robot):
    bench = Bench(robot).run(5.0, 0.5).run(0.0, 0.5)
    assert bench.speed == 0.0
    assert bench.voltages[-1] == 0.0


def test_the_measured_speed_is_quantised_by_the_encoder(robot):
    loop = WheelSpeedLoop(
        robot.wheel_loop.model_copy(update={"speed_filter_s": 0.0}), robot.encoder, robot.power, RATE_HZ
    )
    loop.update(7, 1.0)
    assert loop.speed_rad_s == pytest.approx(7 * 2 * math.pi / 3840 * RATE_HZ)
