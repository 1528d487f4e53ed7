"""What the map lets a robot expect, against closed forms and the simulator's own sensors."""

from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from physics.arena.rays import RayScene
from pipeline.baselines.line_model import LineModel
from pipeline.baselines.range_model import BEAM_SD_SHARE, MOUNT_SD_RAD, RangeModel
from pipeline.baselines.robot_knowledge import Start
from sensors.ranging.tof import TofArray
from symolo.arena.geometry import Arena, Box
from symolo.dataset.codes import TofStatus

START = Start(np.zeros(3), np.full(3, 0.01))
ROWS = 2


@pytest.fixture(scope="module")
def empty(before_a_wall):
    return before_a_wall(np.zeros((ROWS, 2)), np.full(ROWS, np.nan), START)


class Posed:
    """A world in which a robot stands."""

    time_s = 0.0

    def __init__(self, scene, pose):
        self._scene, self._pose = scene, pose

    def pose(self):
        return self._pose

    def cast(self, origins, ends):
        return self._scene.cast(origins, ends)


@pytest.mark.parametrize("x_m", [0.0, 0.2, 0.3])
@pytest.mark.parametrize("rays", [6, 30])
def test_a_wall_ahead_reads_its_distance(empty, x_m, rays):
    expected = RangeModel(empty, rays).expected(np.array([[x_m, 0.0, 0.0]]))
    assert expected[0, 0] == pytest.approx(0.5 - 0.085 - x_m, abs=1e-9)


def test_the_ranges_to_a_wall_ahead_spread_as_one_over_the_cosine(empty):
    """With a profile p over the angle a and weights p cos(a), the ranges are d / cos(a)."""
    view = RangeModel(empty, 400).view(np.zeros(3))
    profile = BEAM_SD_SHARE * np.radians(25.0)
    angle = np.radians(12.5) * np.sqrt((np.arange(100_000) + 0.5) / 100_000)
    weight = np.exp(-0.5 * (angle / profile) ** 2) * np.cos(angle)
    ranges_m = (0.5 - 0.085) / np.cos(angle)
    mean_m = np.average(ranges_m, weights=weight)
    spread_m = np.sqrt(np.average((ranges_m - mean_m) ** 2, weights=weight))
    assert view.spread_m[0] == pytest.approx(spread_m, rel=0.05)
    assert view.share[0] == pytest.approx([0.0, 1.0])


def test_a_beam_that_half_passes_a_box_meets_it_with_half_its_share(empty):
    """The edge of a box straight ahead is on the axis of the front sensor, and the wall is behind it."""
    box = Box("box", "obstacle", (0.25, 0.5, 0.5), (0.1, 1.0, 1.0), 0.0, "white_board")
    arena = replace(empty.map, boxes=(*empty.map.boxes, box))
    view = RangeModel(replace(empty, map=arena), 400).view(np.zeros(3))
    assert view.share[0] == pytest.approx([0.0, 0.5, 0.5], abs=0.02)
    near_m, far_m = 0.2 - 0.085, 0.5 - 0.085
    assert view.spread_m[0] == pytest.approx(0.5 * (far_m - near_m), rel=0.03)


def test_a_sensor_turned_in_its_mount_errs_where_it_looks_at_a_wall_askew(empty):
    """At a distance d from the wall, a thin beam at an angle a to its normal reads d / cos(a), which grows by
    d tan(a) / cos(a) with a.
    """
    thin = replace(empty, drawing=replace(empty.drawing, field_of_view_rad=1e-6))
    poses = np.array([[0.2, 0.1, 0.0], [0.1, 0.0, 0.1]])
    model = RangeModel(thin, 6)
    expected_m, error_m = model.expected_and_turn_error(poses, np.array([0.1, 0.0, 0.2]))
    assert expected_m == pytest.approx(model.expected(poses))
    angle = 0.2 + np.radians([0.0, 45.0, -45.0])
    wall_m = 0.5 - (0.1 + 0.085 * np.cos(0.2))
    slope_m = wall_m * np.abs(np.tan(angle)) / np.cos(angle)
    assert error_m == pytest.approx(MOUNT_SD_RAD * slope_m, rel=0.01)


def test_a_sensor_turned_in_its_mount_has_no_error_where_it_sees_no_target(empty):
    _, error_m = RangeModel(empty, 6).expected_and_turn_error(np.zeros((1, 3)), np.array([0.0, 0.0, np.pi]))
    assert np.all(error_m == 0.0)


def test_with_its_back_to_the_wall_there_is_no_target(empty):
    assert np.isnan(RangeModel(empty, 12).expected(np.array([[0.0, 0.0, np.pi]]))).all()


def test_of_many_rays_it_reads_what_the_sensor_of_the_simulator_reads(empty):
    (spec, *_) = draw_all(load_scenario("smoke", []))
    quiet = {"error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0}
    tof = spec.robot.tof.model_copy(update=quiet)
    arena = Arena.from_config(spec.arena)
    arena = replace(arena, boxes=tuple(replace(box, surface="white_board") for box in arena.boxes))
    mounts = (tof.mounts.front, tof.mounts.left, tof.mounts.right)
    model = RangeModel(replace(empty, map=arena, drawing=replace(empty.drawing, mounts=mounts)), 90)
    rng = np.random.Generator(np.random.PCG64(8))
    poses = np.column_stack([rng.uniform(-0.8, 0.8, 60), rng.uniform(-1.0, 0.8, 60), rng.uniform(-3, 3, 60)])
    sensor, scene = TofArray(tof, arena, 1000, rng), RayScene(arena)
    read = np.array([sensor.sample(Posed(scene, tuple(pose))) for pose in poses.tolist()])
    seen = read[..., 1] == TofStatus.VALID
    expected = model.expected(poses)
    both = seen & ~np.isnan(expected)
    assert both.sum() > 40
    assert (seen == (expected >= tof.min_range_m)).mean() > 0.97
    # 0.25 mm is the white board's own offset; the beam's profile is one of a data sheet.
    assert np.median(np.abs(expected - read[..., 0])[both]) < 0.001
    assert np.percentile(np.abs(expected - read[..., 0])[both], 90) < 0.006


def test_channels_over_the_tape_are_likeliest_where_the_tape_is(empty):
    """Line along y at x = 9..9.5, y = 9; the robot heads along it, its line sensor 8 cm ahead."""
    model = LineModel(empty)
    offsets = np.linspace(-0.03, 0.03, 61)
    poses = np.column_stack([np.full(61, 9.1), 9.0 + offsets, np.zeros(61)])
    channels_m = (np.arange(8) - 3.5) * 0.009525
    for robot_left_m in (-0.012, 0.0, 0.015):
        on_line = np.abs(channels_m + robot_left_m) < 0.0075
        best = offsets[np.argmax(model.log_likelihood(poses, on_line))]
        assert best == pytest.approx(robot_left_m, abs=0.005)


def test_no_channel_over_the_tape_is_likely_off_it(empty):
    on, away = LineModel(empty).log_likelihood(np.array([[9.1, 9.0, 0.0], [5.0, 5.0, 0.0]]), np.zeros(8, dtype=bool))
    assert away > on + 3.0
