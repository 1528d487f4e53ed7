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


@pytest.fixture
def by_hand(robot):
    """A loop whose terms are round numbers: 1 count in 0.01 s is 1 rad/s, and the filter moves half of the way."""
    gains = {
        "speed_filter_s": 0.01,
        "feedforward_V_s_rad": 0.5,
        "feedforward_static_V": 0.25,
        "proportional_V_s_rad": 0.1,
        "integral_V_rad": 2.0,
    }
    power = robot.power.model_copy(update={"battery_voltage_V": 6.0})
    loop = WheelSpeedLoop(robot.wheel_loop.model_copy(update=gains), robot.encoder, power, RATE_HZ)
    loop._rad_s_per_count = 1.0
    return loop


@pytest.mark.parametrize("sign", [1, -1])
def test_the_voltage_is_the_feed_forward_and_the_two_terms_of_the_error(by_hand, sign):
    by_hand.restart(1000)
    # Filtered speed 2, error 6 - 2 = 4: 0.5 * 6 + 0.25 + 0.1 * 4; then the integral is 2 * 4 * 0.01 = 0.08.
    assert by_hand.update(1000 + sign * 4, sign * 6.0) == pytest.approx(sign * 3.65)
    # Filtered speed 2 + (8 - 2) / 2 = 5, error 1.
    assert by_hand.update(1000 + sign * 12, sign * 6.0) == pytest.approx(sign * (3.25 + 0.1 + 0.08))
    # The wheel still turns at a set point of zero: no friction is fed forward. Speed 5 - 2, error -3, integral 0.1.
    assert by_hand.update(1000 + sign * 13, 0.0) == pytest.approx(sign * (-0.3 + 0.1))
    by_hand.restart(0)
    assert by_hand.speed_rad_s == 0.0
    assert by_hand.update(0, sign * 1.0) == pytest.approx(sign * (0.5 + 0.25 + 0.1))


@pytest.mark.parametrize("sign", [1, -1])
def test_at_the_limit_the_integral_changes_only_away_from_it(by_hand, sign):
    by_hand.restart(0)
    assert by_hand.update(0, sign * 100.0) == sign * 6.0
    assert by_hand._integral_V == 0.0
    # 0.5 * 20 + 0.25 is beyond the limit, but the wheel turns at 40 rad/s, which is too fast by 20.
    assert by_hand.update(sign * 80, sign * 20.0) == sign * 6.0
    assert by_hand._integral_V == pytest.approx(sign * -20.0 * 2.0 * 0.01)


@pytest.mark.parametrize("sign", [1, -1])
def test_just_beyond_the_limit_the_integral_does_not_grow_by_a_small_error_either(by_hand, sign):
    """0.5 * 12 + 0.25 + 0.1 * 0.5 are 0.3 V beyond the limit, and the wheel is too slow by 0.5."""
    by_hand.restart(0)
    assert by_hand.update(sign * 23, sign * 12.0) == sign * 6.0
    assert by_hand._integral_V == 0.0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("set_point", "counts", "error"),
    [(12.0, 25, -0.5), (24.0, 53, -2.5), (20.0, 40, 0.0)],
    ids=["just beyond the limit", "at twice the limit", "at the set point"],
)
def test_the_integral_leaves_the_limit_by_the_error_however_far_beyond_it_is(by_hand, sign, set_point, counts, error):
    """Half of the counts is the filtered speed: the voltage would be 6.2, 12 and 10.25 at a limit of 6."""
    by_hand.restart(0)
    assert by_hand.update(sign * counts, sign * set_point) == sign * 6.0
    assert by_hand._integral_V == pytest.approx(sign * error * 2.0 * 0.01)


def test_a_wheel_at_rest_that_shall_rest_gets_no_voltage_and_forgets_its_integral(by_hand):
    by_hand.restart(0)
    by_hand.update(0, 2.0)
    assert by_hand._integral_V > 0.0
    assert by_hand.update(0, 0.0) == 0.0
    assert by_hand._integral_V == 0.0
