"""VL53L0X: readings of worlds with a closed form, against the paper's tables and equations."""

import math
from functools import reduce

import numpy as np
import pytest

from configs.effects.robot_effects import RobotEffects
from sensors.base import Sampling
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting
from sensors.ranging.tof import Light, TofArray, log_error_m, noise_sd_m, ray_directions, ray_pattern
from symolo.dataset.codes import TofStatus

FRONT = 0
NONE = RobotEffects()
NO_TARGET_M = 2.0


def sensors(robot, arena, *effects, **changes):
    config = robot.tof.model_copy(update={"error_scale": 0.0} | changes)
    return TofArray(config, arena, 1000, np.random.default_rng(0), reduce(RobotEffects.with_effect, effects, NONE))


class Draws:
    """A generator that gives these uniform numbers, and normal deviates that are all equal."""

    def __init__(self, numbers=(1.0, 1.0, 1.0), deviate=0.0):
        self.numbers, self.deviate = np.array(numbers), deviate

    def random(self, size):
        assert size == len(self.numbers)
        return self.numbers

    def standard_normal(self, size):
        return np.full(size, self.deviate)


@pytest.fixture
def mean_and_sd_mm(monkeypatch):
    """The reading of the front sensor for a deviate of 0, and by how much that of 1 is longer."""

    def of(tof, world):
        readings_mm = []
        for deviate in (0.0, 1.0, -1.0):
            monkeypatch.setattr(tof, "_rng", Draws(deviate=deviate))
            readings_mm.append(1e3 * tof.sample(world)[FRONT, 0])
        mean_mm, above_mm, below_mm = readings_mm
        assert above_mm - mean_mm == pytest.approx(mean_mm - below_mm)
        return mean_mm, above_mm - mean_mm

    return of


def wall_ahead(plane_world, robot, distance_m):
    return plane_world(wall_x_m=robot.tof.mounts.front.x_m + distance_m)


@pytest.mark.parametrize("distance_m", [0.05, 0.1, 0.25, 0.6, 1.15])
def test_a_wall_met_head_on_reads_its_distance(robot, arena_of, plane_world, distance_m):
    tof = sensors(robot, arena_of(), noise_scale=0.0)
    reading, status = tof.sample(wall_ahead(plane_world, robot, distance_m))[FRONT]
    assert status == TofStatus.VALID
    # White paper board reads 0.25 mm long (Table 3), and the device gives whole millimetres.
    assert reading == pytest.approx(distance_m + 0.00025, abs=0.0005001)


@pytest.mark.parametrize(
    ("surface", "mean_mm", "sd_mm"),
    [
        ("white_board", 100.25, 0.84),
        ("light_grey_board", 100.21, 0.82),
        ("dark_grey_board", 101.24, 0.79),
        ("black_board", 95.63, 0.80),
        ("metal", 89.06, 1.28),
        ("wood", 99.88, 1.42),
        ("glass", 96.58, 1.77),
        ("paper", 101.42, 1.45),
        ("plastic", 99.7, 1.31),
    ],
)
def test_readings_at_100_mm_are_those_of_tables_3_and_4(
    robot, arena_of, plane_world, mean_and_sd_mm, surface, mean_mm, sd_mm
):
    tof = sensors(robot, arena_of(surface), quantisation_m=0.0)
    assert mean_and_sd_mm(tof, wall_ahead(plane_world, robot, 0.1)) == pytest.approx((mean_mm, sd_mm))


def test_noise_of_a_surface_with_the_equations_own_deviation_is_equation_23():
    by_hand_mm = 1.15 * 0.5**3 + 2.51 * 0.5**2 + 4.88 * 0.5 + 1.40
    sd_mm = 1e3 * noise_sd_m(np.full(4, 0.00141), np.array([0.05, 0.1, 0.18, 0.68]))
    assert sd_mm == pytest.approx([1.41, 1.41, 1.41, by_hand_mm])


@pytest.mark.parametrize(("surface", "own_mm"), [("white_board", 0.84), ("glass", 1.77)])
def test_readings_at_600_mm_scatter_as_equation_23_and_the_surface_add_up(
    robot, arena_of, plane_world, mean_and_sd_mm, surface, own_mm
):
    tof = sensors(robot, arena_of(surface), quantisation_m=0.0)
    _, sd_mm = mean_and_sd_mm(tof, wall_ahead(plane_world, robot, 0.6))
    eq_23_mm = 1.15 * 0.42**3 + 2.51 * 0.42**2 + 4.88 * 0.42 + 1.40
    assert sd_mm == pytest.approx(math.sqrt(own_mm**2 + eq_23_mm**2 - 1.41**2), rel=1e-4)
    assert sd_mm == pytest.approx(eq_23_mm, rel=0.10)


def test_the_error_is_equation_24_with_its_zero_at_180_mm():
    assert log_error_m(np.array([0.04, 0.18])) == pytest.approx(0.0)
    assert 1e3 * log_error_m(np.array([1.0]))[0] == pytest.approx(102.5, abs=0.05)


def test_the_sensors_on_a_robot_have_its_settings_and_its_effects(robot, arena_of, plane_world):
    exact = {"noise_scale": 0.0, "quantisation_m": 0.0, "error_scale": 0.0, "period_s": 0.02}
    changed = robot.model_copy(update={"tof": robot.tof.model_copy(update=exact)})
    tof = TofArray.on_robot(
        changed.with_effect(RangeOffset(offset_m=0.012)), arena_of(), 1000, np.random.default_rng(0)
    )
    assert tof.sample(wall_ahead(plane_world, robot, 0.3))[FRONT, 0] == pytest.approx(0.3 + 0.00025 + 0.012, rel=1e-4)
    assert tof.sampling == Sampling(20, 0)


def test_nothing_ahead_is_no_target(robot, arena_of, plane_world):
    for floor in (False, True):
        readings = sensors(robot, arena_of()).sample(plane_world(floor=floor))
        assert readings[:, 0].tolist() == [NO_TARGET_M] * 3
        assert readings[:, 1].tolist() == [TofStatus.NO_TARGET] * 3


@pytest.mark.parametrize("distance_m", [0.02, 1.3])
def test_a_wall_out_of_range_is_no_target(robot, arena_of, plane_world, distance_m):
    reading, status = sensors(robot, arena_of()).sample(wall_ahead(plane_world, robot, distance_m))[FRONT]
    assert (reading, status) == (NO_TARGET_M, TofStatus.NO_TARGET)


@pytest.mark.parametrize(
    ("signal", "range_m", "is_target"),
    [(0.02, 0.04, True), (0.0199, 0.04, False), (1.0, 0.0399, False), (0.02, 1.2, True), (1.0, 1.2001, False)],
)
def test_the_least_signal_and_both_ends_of_the_range_are_still_a_target(robot, arena_of, signal, range_m, is_target):
    tof = sensors(robot, arena_of(), signal_threshold=0.02, min_range_m=0.04, max_range_m=1.2)
    expected = (range_m, TofStatus.VALID) if is_target else (NO_TARGET_M, TofStatus.NO_TARGET)
    assert tof._judged(signal, range_m) == expected


@pytest.mark.parametrize("exponent", [0.0, 2.0])
def test_rays_are_weighed_by_the_beam_and_the_cosine_of_their_incidence(robot, arena_of, plane_world, exponent):
    """Against a quadrature over the cone, for a front sensor that sees the floor and a wall 0.6 m ahead.

    By an effect, near rays may have more weight besides. Then the device is calibrated head-on with these weights.
    """
    exact = {"noise_scale": 0.0, "quantisation_m": 0.0, "rays": 1000, "field_of_view_deg": 50.0}
    tof = sensors(robot, arena_of(), RangeSignalWeighting(exponent=exponent), **exact)
    # Even in the square of the angle off the axis, as the spiral is, and in the angle around it.
    angle = np.radians(25.0) * np.sqrt((np.arange(400) + 0.5) / 400)[:, None]
    roll = (np.arange(400) + 0.5) * 2.0 * np.pi / 400
    beam = np.exp(-0.5 * (angle / np.radians(robot.tof.beam_sigma_deg)) ** 2)
    ahead, down = np.cos(angle) * np.ones(400), -np.sin(angle) * np.sin(roll)
    slant_m = np.minimum(0.6 / ahead, robot.tof.mounts.front.z_m / np.maximum(down, 1e-9))
    is_wall = ahead * slant_m > 0.6 - 1e-9
    weight = beam * np.where(is_wall, ahead, down) * slant_m**-exponent
    offset_m = 0.00025 * np.average(is_wall, weights=weight)
    head_on = np.average(np.cos(angle), weights=beam * np.cos(angle) ** exponent)
    expected_m = np.average(slant_m, weights=weight) * head_on + offset_m
    reading_m = tof.sample(plane_world(wall_x_m=robot.tof.mounts.front.x_m + 0.6, floor=True))[FRONT, 0]
    assert reading_m == pytest.approx(expected_m, rel=2e-3)


@pytest.mark.parametrize("exponent", [0.0, 6.0])
@pytest.mark.parametrize("rays", [1, 90])
def test_a_wall_met_head_on_reads_its_distance_however_rays_are_weighed(robot, arena_of, plane_world, exponent, rays):
    """The mean is weighted, so it does not depend on the amount of light, and the device is calibrated with weights."""
    tof = sensors(
        robot, arena_of(), RangeSignalWeighting(exponent=exponent), noise_scale=0.0, quantisation_m=0.0, rays=rays
    )
    reading_m = tof.sample(wall_ahead(plane_world, robot, 0.6))[FRONT, 0]
    assert reading_m == pytest.approx(0.6 + 0.00025, abs=1e-9)


@pytest.mark.parametrize("yaw_deg", [10, 30, 50])
def test_a_slanted_wall_reads_its_distance_along_the_axis(robot, arena_of, plane_world, yaw_deg):
    """The cosine of incidence in the weight cancels that in the length of a ray, whatever the beam is."""
    tof = sensors(robot, arena_of(), noise_scale=0.0, quantisation_m=0.0)
    mount, yaw = robot.tof.mounts.front, math.radians(yaw_deg)
    world = plane_world(wall_x_m=mount.x_m * math.cos(yaw) - mount.y_m * math.sin(yaw) + 0.2, at=(0.0, 0.0, yaw))
    assert tof.sample(world)[FRONT, 0] == pytest.approx(0.2 / math.cos(yaw) + 0.00025, rel=5e-3)


def test_side_sensors_look_45_degrees_to_their_side(robot, arena_of, plane_world):
    """Turned right by 45 degrees, the left sensor meets a wall ahead head-on, and the right one looks along it."""
    mount = robot.tof.mounts.left
    yaw = -math.pi / 4
    sensor_x = mount.x_m * math.cos(yaw) - mount.y_m * math.sin(yaw)
    world = plane_world(wall_x_m=sensor_x + 0.2, at=(0.0, 0.0, yaw))
    _, left, right = sensors(robot, arena_of(), noise_scale=0.0).sample(world)
    assert left[0] == pytest.approx(0.20025, abs=0.0005001)
    assert right[1] == TofStatus.NO_TARGET


def test_a_lost_update_keeps_the_value_before_and_says_so(robot, arena_of, plane_world):
    tof = sensors(robot, arena_of(), noise_scale=0.0)
    good = tof.sample(wall_ahead(plane_world, robot, 0.1))[FRONT, 0]
    tof._config = tof._config.model_copy(update={"dropout_probability": 1.0})
    reading, status = tof.sample(wall_ahead(plane_world, robot, 0.3))[FRONT]
    assert (reading, status) == (good, TofStatus.HELD)


def test_a_log_has_range_and_status_in_columns_of_their_own(robot, arena_of):
    range_m, status = sensors(robot, arena_of()).recorded(np.array([[0.5, 0.0], [2.0, 1.0], [0.25, 2.0]]))
    assert range_m.tolist() == [0.5, 2.0, 0.25]
    assert status.tolist() == [TofStatus.VALID, TofStatus.NO_TARGET, TofStatus.HELD]
    assert status.dtype == np.int64


def test_an_update_is_lost_where_its_number_is_below_the_probability(robot, arena_of, plane_world, monkeypatch):
    """Before the first update there is no target, so that this is what is held."""
    tof = sensors(robot, arena_of(), dropout_probability=0.3)
    monkeypatch.setattr(tof, "_rng", Draws([0.299, 0.3, 0.301]))
    readings = tof.sample(wall_ahead(plane_world, robot, 0.1))
    assert readings[0].tolist() == [NO_TARGET_M, TofStatus.HELD]
    assert TofStatus.HELD not in readings[1:, 1]


def test_a_share_of_equation_24_is_added_to_the_range(robot, arena_of, plane_world):
    tof = sensors(robot, arena_of(), error_scale=0.3, noise_scale=0.0)
    reading = tof.sample(wall_ahead(plane_world, robot, 0.6))[FRONT, 0]
    assert reading == pytest.approx(0.60025 + 0.3 * 0.05977 * math.log(0.6 / 0.18), abs=0.0005001)


def test_the_floor_has_no_offset_and_the_noise_of_equation_23(robot, arena_of, plane_world):
    """A sensor that looks straight down reads its height."""
    front = robot.tof.mounts.front.model_copy(update={"pitch_up_deg": -90.0})
    mounts = robot.tof.mounts.model_copy(update={"front": front})
    world = plane_world(floor=True)
    still = sensors(robot, arena_of("metal"), mounts=mounts, noise_scale=0.0, quantisation_m=0.0)
    assert still.sample(world)[FRONT, 0] == pytest.approx(front.z_m, rel=1e-6)
    noisy = sensors(robot, arena_of("metal"), mounts=mounts, quantisation_m=0.0)
    readings_mm = 1e3 * np.array([noisy.sample(world)[FRONT, 0] for _ in range(400)])
    assert readings_mm.std() == pytest.approx(1.41, rel=0.1)


def test_weights_of_near_rays_change_the_mean_and_not_whether_enough_light_returns(robot, arena_of, plane_world):
    """Of a wall that is met at 50 degrees, the share cos 50 of the light of one head-on, whatever its distance."""
    yaw = math.radians(50.0)
    for weighting in ((), (RangeSignalWeighting(exponent=6.0),)):
        for distance_m in (0.1, 0.5):
            world = plane_world(robot.tof.mounts.front.x_m * math.cos(yaw) + distance_m, at=(0.0, 0.0, yaw))
            for signal, status in ((0.995, TofStatus.VALID), (1.005, TofStatus.NO_TARGET)):
                settings = {"signal_threshold": signal * math.cos(yaw), "noise_scale": 0.0}
                assert sensors(robot, arena_of(), *weighting, **settings).sample(world)[FRONT, 1] == status


def test_rays_end_a_quarter_beyond_the_largest_range(robot, arena_of, plane_world):
    world, lengths_m = plane_world(), []

    class Watched:
        pose, encoder_counts = world.pose, world.encoder_counts
        time_s = 0.0

        def cast(self, origins, ends):
            lengths_m.extend(np.linalg.norm(ends - origins, axis=1))
            return world.cast(origins, ends)

    sensors(robot, arena_of(), max_range_m=1.2).sample(Watched())
    assert lengths_m == pytest.approx([1.5] * 270)


def test_a_mount_turns_its_axis_up_and_then_to_the_left(robot):
    mount = robot.tof.mounts.left.model_copy(update={"pitch_up_deg": 30.0, "yaw_deg": 60.0})
    (axis,) = ray_directions(mount, np.zeros(1), np.zeros(1))
    assert axis == pytest.approx([math.sqrt(3) / 4, 0.75, 0.5])
    # Off the axis by 90 degrees: a roll of 0 is the left of the mount, one of 90 degrees its top.
    sides = ray_directions(mount, np.full(2, np.pi / 2), np.array([0.0, np.pi / 2]))
    assert sides[0] == pytest.approx([-math.sqrt(3) / 2, 0.5, 0.0])
    assert sides[1] == pytest.approx([-0.25, -math.sqrt(3) / 4, math.sqrt(3) / 2])
    (further,) = ray_directions(mount, np.zeros(1), np.zeros(1), np.radians(30.0))
    assert further == pytest.approx([0.0, math.sqrt(3) / 2, 0.5])


def test_90_rays_fill_a_cone_of_25_degrees_about_the_axis(robot):
    angle, roll = ray_pattern(90, math.radians(25.0))
    directions = ray_directions(robot.tof.mounts.left, angle, roll)
    axis = np.array([math.cos(math.pi / 4), math.sin(math.pi / 4), 0.0])
    off_axis = np.degrees(np.arccos(directions @ axis))
    assert len(directions) == 90
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    assert off_axis.max() <= 12.5
    assert off_axis.max() == pytest.approx(12.5, abs=0.1)
    assert directions.mean(axis=0) / np.linalg.norm(directions.mean(axis=0)) == pytest.approx(axis, abs=2e-3)
    # Vogel, Math. Biosci. 44 (1979) 179-189: from one point of a sunflower to the next it is 137.508 degrees.
    assert np.degrees(np.diff(roll)) == pytest.approx(137.508, abs=1e-3)
    # Even over the disc: half of the rays lie within 1 / sqrt(2) of the radius.
    assert np.count_nonzero(off_axis < 12.5 / math.sqrt(2)) == 45


def test_light_that_has_returned_cannot_be_changed(changeable):
    assert changeable(Light) == []
