"""Further encoders: every principle counts what the wheel turned."""

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.stages.simulate import simulate
from sensors.wheels.wheel_encoder import WheelEncoder, WheelEncoderSettings


class Wheels:
    def __init__(self, *angles_rad):
        self.angles = angles_rad

    def wheel_angles(self):
        return self.angles


def counts(angles_rad, **settings):
    device = WheelEncoder(WheelEncoderSettings.model_validate(settings), None, 1000, np.random.default_rng(4))
    return [device.sample(Wheels(angle, -angle))[0] for angle in angles_rad]


def test_a_turn_has_the_counts_of_its_resolution():
    there_and_back = [0.0, 2 * np.pi, 6 * np.pi, 2 * np.pi]
    assert counts(there_and_back, counts_per_revolution=20) == [0, 20, 60, 20]
    assert counts(there_and_back, counts_per_revolution=20, wheel="left") == [0, -20, -60, -20]


def test_a_single_channel_does_not_know_the_direction():
    there_and_back = [0.0, 2 * np.pi, 6 * np.pi, 2 * np.pi]
    assert counts(there_and_back, counts_per_revolution=20, principle="single") == [0, 20, 60, 100]


def test_an_absolute_encoder_gives_the_position_within_the_turn():
    positions = counts([0.0, np.pi, 2 * np.pi, 3 * np.pi], counts_per_revolution=4096, principle="absolute")
    assert positions[0] == positions[2]
    assert abs(positions[1] - positions[0]) == 2048
    assert 0 <= min(positions) <= max(positions) < 4096


def test_a_lost_reading_leaves_the_one_before():
    assert counts([0.0, 2 * np.pi], counts_per_revolution=20, dropout_probability=1.0) == [0, 0]


def test_in_a_run_it_counts_the_same_turns_as_the_encoders_of_the_robot():
    settings = ["robot.sensors.wheel_encoder={counts_per_revolution: 960, wheel: left}", "stop.time_limit_s=2"]
    recording = simulate(draw_run(load_scenario("smoke", settings), "CW", 1)).recording
    series, fine = recording["sensor_wheel_encoder"], recording["encoder_counts"]
    at_rows = series.values[::5, 0]
    # The nominal robot has 3840 counts a turn, four times as many; both start at any place between two edges.
    assert np.abs(at_rows - fine.values[:, 1] / 4).max() <= 1.0
    assert at_rows[-1] > 100
    assert series.t_s[5] == pytest.approx(0.05)
