"""The clock of each sensor in `benchmarks/speed/simulation_speed.py`."""

import importlib

from configs.draw import draw_run
from configs.loader import load_scenario

SETTINGS = ("stop.time_limit_s=0.1", "robot.sensors={imu: {}}")


def test_the_time_of_every_sensor_is_a_share_of_the_run():
    shares = importlib.import_module("simulation_speed").time_sensors(
        draw_run(load_scenario("smoke", SETTINGS), "CW", 1)
    )
    assert {"tof", "line", "encoders", "imu"} <= shares.keys()
    assert all(share > 0 for share in shares.values())
    assert sum(shares.values()) < 1
