"""A further VL53L0X: the modes of its data sheet, and the physics that the nominal sensors leave out."""

from dataclasses import dataclass

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.arena.rays import RayScene
from pipeline.stages.simulate import simulate
from sensors.ranging.vl53l0x import MODES, Vl53l0x, Vl53l0xSettings
from symolo.arena.geometry import Arena, Box, Line
from symolo.core.errors import InputError

PLAIN = {"error_scale": 0.0, "near_error_m": 0.0, "tilt_sd_m_rad": 0.0, "wander_sd_m": 0.0, "quantisation_m": 0.0}
VALID, NO_TARGET = 0, 1


@dataclass
class Approach:
    """A robot that drives along x towards the boxes of an arena."""

    arena: Arena
    speed_m_s: float = 0.0
    time_s: float = 0.0

    def pose(self):
        return self.speed_m_s * self.time_s, 0.0, 0.0

    def cast(self, origins, ends):
        return RayScene(self.arena).cast(origins, ends)


def arena(*boxes):
    return Arena("test", 20.0, 0.8, Line((), 0.015, reflectance=0.0), boxes)


def wall(x_m, surface="white_board", y_m=0.0, width_m=4.0):
    return Box(f"wall_{x_m}", "wall", (x_m + 0.5, y_m, 1.0), (1.0, width_m, 2.0), 0.0, surface)


def device(walled, seed=0, **settings):
    full = Vl53l0xSettings.model_validate({**PLAIN, "z_m": 0.8, **settings})
    return Vl53l0x(full, walled, 1000, np.random.default_rng(seed))


def readings(walled, count=1, **settings):
    sensor = device(walled, **settings)
    return np.array([sensor.sample(Approach(walled, time_s=float(number))) for number in range(count)])


def test_before_a_white_board_it_reads_what_the_paper_measured():
    range_mm, status = 1e3 * readings(arena(wall(0.1)), 800).T
    assert (status == VALID).all()
    assert range_mm.mean() == pytest.approx(100.25, abs=0.1)  # Table 3
    assert range_mm.std() == pytest.approx(0.84, rel=0.1)


@pytest.mark.parametrize(("mode", "budget_ms"), [("default", 30), ("high_speed", 20), ("high_accuracy", 200)])
def test_a_mode_with_a_longer_budget_averages_more_pulses(mode, budget_ms):
    range_mm = 1e3 * readings(arena(wall(0.1)), 800, mode=mode)[:, 0]
    assert range_mm.std() == pytest.approx(0.84 * np.sqrt(30 / budget_ms), rel=0.1)


def test_white_is_seen_at_the_reach_of_the_data_sheet_and_far_targets_become_rare():
    # Data sheet: 1.2 m in the default mode and 2 m with long range, for 88 % and in 94 % of the readings.
    share = {
        (mode, x_m): np.mean(readings(arena(wall(x_m)), 400, mode=mode)[:, 1] == VALID)
        for mode, x_m in (("default", 1.0), ("default", 1.2), ("default", 2.0), ("long_range", 2.0))
    }
    assert share["default", 1.0] > 0.99
    assert share["default", 1.2] > 0.9
    assert share["default", 2.0] < 0.1
    assert share["long_range", 2.0] > 0.9
    black = np.mean(readings(arena(wall(0.5, "black_board")), 400)[:, 1] == VALID)
    assert black < 0.1  # it returns as much as white at 0.5 * sqrt(0.88 / 0.05) = 2.1 m


def test_below_40_mm_readings_are_too_long_and_some_fail():
    range_m, status = readings(arena(wall(0.02)), 600, near_error_m=0.01).T
    assert 0.4 < np.mean(status == VALID) < 0.6
    assert range_m[status == VALID].mean() == pytest.approx(0.02 + 0.01 / np.e + 0.00025, abs=5e-4)


def test_near_parts_outweigh_far_ones():
    step = arena(wall(0.1, y_m=2.0), wall(0.3))  # the left half of the beam ends at 0.1 m
    plain, weighted = (readings(step, signal_exponent=exponent, noise_scale=0.0)[0, 0] for exponent in (0.0, 2.0))
    # Half of the light from each: a mean with weights 1 / d^2 is (1 / 0.1 + 1 / 0.3) / (1 / 0.01 + 1 / 0.09) = 0.12.
    assert plain == pytest.approx(0.2, abs=0.012)
    assert weighted == pytest.approx(0.12, abs=0.006)


def test_light_is_gathered_over_the_budget():
    sensor = device(arena(wall(1.0)), mode="high_accuracy", noise_scale=0.0)
    world = Approach(sensor.arena, speed_m_s=0.5)
    before = sensor.sampling.subsamples_before
    for step in (*(400 - subsample for subsample in before), 400):
        world.time_s = step / 1000
        reading = sensor.sample(world) if step == 400 else sensor.subsample(world)
    # At 0.4 s the wall is 0.8 m away; the mean over 0.2 s is that of 0.1 s before. The board reads 0.25 mm more.
    assert reading[0] == pytest.approx(0.8 + 0.1 * 0.5 + 0.00025, abs=1e-4)


def test_tilting_forwards_differs_from_tilting_backwards_and_sideways_does_not():
    def asymmetry(seed, **tilt):
        there, back = (
            readings(arena(wall(0.2)), seed=seed, tilt_sd_m_rad=0.02, noise_scale=0.0, **{key: sign * 20.0})[0, 0]
            for key, sign in ((*tilt, 1), (*tilt, -1))
        )
        return there - back

    forward = [asymmetry(seed, pitch_up_deg=0) for seed in range(20)]
    assert min(forward) < -1e-3 < 1e-3 < max(forward)
    assert max(abs(asymmetry(seed, yaw_deg=0)) for seed in range(5)) < 5e-4
    rolled = {"roll_deg": 90.0}
    turned = readings(arena(wall(0.2)), tilt_sd_m_rad=0.02, noise_scale=0.0, yaw_deg=20.0, **rolled)[0, 0]
    back = readings(arena(wall(0.2)), tilt_sd_m_rad=0.02, noise_scale=0.0, yaw_deg=-20.0, **rolled)[0, 0]
    assert abs(turned - back) > 1e-3  # the axis of the asymmetry rolls with the device


def test_the_slow_error_wanders_with_its_standard_deviation():
    errors = [readings(arena(wall(0.2)), seed=seed, wander_sd_m=0.002, noise_scale=0.0)[0, 0] for seed in range(300)]
    assert np.std(errors) == pytest.approx(0.002, rel=0.15)


def test_an_effect_acts_on_it_alone_and_one_of_another_sensor_is_refused():
    still = readings(arena(wall(0.2)), noise_scale=0.0)[0, 0]
    shifted = readings(arena(wall(0.2)), noise_scale=0.0, effects={"range_offset": {"offset_m": 0.03}})[0, 0]
    assert shifted - still == pytest.approx(0.03)
    with pytest.raises(InputError, match=r"effects\.line_ambient: it does not act on this sensor.*range_offset"):
        load_scenario("smoke", ["robot.sensors.vl53l0x.effects.line_ambient.offset=0.1"])


def test_its_period_follows_the_mode_and_is_never_shorter_than_the_budget():
    assert Vl53l0xSettings().period_s == 0.033
    assert Vl53l0xSettings.model_validate({"mode": "high_accuracy"}).period_s == 0.2
    assert [mode.budget_s for mode in MODES.values()] == [0.03, 0.02, 0.2, 0.033]
    with pytest.raises(InputError, match=r"period_s: got 0\.05, allowed: at least 0\.2, the timing budget"):
        load_scenario("smoke", ["robot.sensors.vl53l0x={mode: high_accuracy, period_s: 0.05}"])


def test_a_run_has_its_readings_at_its_own_period():
    setting = "robot.sensors.rear={kind: vl53l0x, x_m: -0.085, z_m: 0.075, yaw_deg: 180, mode: {choice: [high_speed]}}"
    spec = draw_run(load_scenario("smoke", [setting, "stop.time_limit_s=1"]), "CW", 1)
    assert spec.robot.sensors.get("rear").period_s == 0.033
    series = simulate(spec).recording["sensor_rear"]
    np.testing.assert_allclose(series.t_s, np.arange(31) * 0.033)
