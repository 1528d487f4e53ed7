"""A data.csv from elsewhere in other units than ours: told before anything is made; what fits is left alone."""

import math

import numpy as np
import pytest

from blender_scenes.scene.run_scene import arena_bounds
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from pipeline.rerendering.rerender import RerenderRequest
from pipeline.run_warnings.imported_trajectory import check_possible
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.dataset.tables.rows import Rows

ROWS, EVERY = 200, 10
"""In each drive, and from image to image."""


def circle(laps=1.0, radius_m=0.3):
    """Poses (N, 3) with the yaw along the circle, unwrapped."""
    angle = np.linspace(0.0, 2 * math.pi * laps, ROWS)
    return np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle), angle + 0.5 * math.pi], axis=1)


def straight(yaw_rad):
    along_m = np.linspace(-0.4, 0.4, ROWS)
    return np.stack([along_m * math.cos(yaw_rad), along_m * math.sin(yaw_rad), np.full(ROWS, yaw_rad)], axis=1)


def moved(pose, x_m=0.0, yaw_rad=0.0):
    return pose + np.array([x_m, 0.0, yaw_rad])


def written(path, pose, period_ms=50):
    numbers = np.arange(ROWS)
    image = np.where(numbers % EVERY == 0, 1 + numbers // EVERY, 0)
    one = np.ones((ROWS, 8))
    path.write_bytes(Rows(period_ms * numbers, pose.copy(), 0 * numbers, one[:, :2], one[:, :3], one, image).to_csv())
    return path


def in_degrees(pose):
    return pose * np.array([1.0, 1.0, 180 / math.pi])


def with_noise(pose):
    return pose + np.random.default_rng(5).normal(0.0, (0.001, 0.001, 0.02), pose.shape)


LOOK = RerenderRequest(("lab",))


def test_places_in_millimetres_are_one_clear_line(tmp_path, symolo):
    path = written(tmp_path / "elsewhere.csv", circle() * [1000.0, 1000.0, 1.0])
    ended = symolo("rerender", path, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert f"{path}:2: column x: the robot moves at 189 m/s" in ended.err
    assert "give x and y in metres; this looks like millimetres" in ended.err
    assert list(tmp_path.iterdir()) == [path]


def test_a_path_far_away_is_moved_to_a_floor_that_fits_it(tmp_path, prepared):
    (run,) = prepared(written(tmp_path / "elsewhere.csv", moved(circle(), 1e6)), LOOK)
    assert np.abs(run.rows.pose[:, :2]).max() == pytest.approx(0.3, abs=1e-3)
    assert run.spec.arena.name == "floor"
    assert any("are moved by (-1e+06, 0) m" in text for text in run.spec.origin.log.changes)


def test_the_first_image_outside_is_named_and_rows_without_one_may_be_anywhere(tmp_path, prepared):
    pose = circle()
    pose[3 * EVERY + 1, 0] = 20.0
    prepared(written(tmp_path / "data.csv", pose), LOOK)
    pose[[4 * EVERY, 5 * EVERY], 1] = -20.0
    with pytest.raises(InputError, match=rf"data\.csv:{4 * EVERY + 2}: x = .*, y = -20 m is outside"):
        prepared(written(tmp_path / "data.csv", pose), LOOK)


def test_the_room_and_not_the_arena_is_what_counts(tmp_path, prepared):
    """Its floor ends so far east of all that stands in the arena as the look says."""
    arena = Arena.from_config(ArenaConfig.model_validate(load_section("arena", "symolo").tree))
    _, (east_m, _) = arena_bounds(arena)
    request = RerenderRequest(("lab",), overrides=("look.room.margin_east_m=1.5",))
    prepared(written(tmp_path / "in.csv", moved(circle(), east_m + 1.49 - 0.3)), request)
    with pytest.raises(InputError, match="is outside the room"):
        prepared(written(tmp_path / "out.csv", moved(circle(), east_m + 1.51 - 0.3)), request)


def test_headings_of_a_table_in_degrees_are_named_with_the_unit_of_a_mapping():
    pose = in_degrees(circle())
    t_s = 0.05 * np.arange(len(pose))
    with pytest.raises(InputError, match=r"write unit: degrees for theta_rad in a mapping file, which --map names"):
        check_possible(t_s, pose, "row {}".format, in_milliseconds=False)


@pytest.mark.parametrize(
    "pose",
    [in_degrees(circle()), in_degrees(with_noise(circle(3))), *(in_degrees(straight(yaw)) for yaw in (-1.5, 0.8, 3))],
    ids=["a lap", "laps with noise", "south", "north-east", "west"],
)
def test_headings_in_degrees_are_one_clear_line(pose, tmp_path, symolo):
    path = written(tmp_path / "elsewhere.csv", pose)
    ended = symolo("rerender", path, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    line = 2 + int(np.flatnonzero(np.abs(pose[:, 2]) > 2 * math.pi)[0])
    assert f"{path}:{line}: column theta: " in ended.err
    assert "give theta in radians" in ended.err
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    "pose",
    [
        circle(5),
        with_noise(circle()),
        moved(circle(5), yaw_rad=math.pi),
        circle(5) * [1.0, 1.0, -1.0],
        circle(20, radius_m=0.0),
        *(straight(yaw) for yaw in (0.0, 0.8, 40 * math.pi)),
    ],
    ids=["unwrapped", "with noise", "backwards", "clockwise yaw", "on the spot", "east", "north-east", "many turns"],
)
def test_headings_that_degrees_do_not_explain_are_left_alone(pose, tmp_path, prepared):
    prepared(written(tmp_path / "data.csv", pose), LOOK)


def test_times_in_seconds_make_a_speed_that_no_small_robot_has(tmp_path, symolo):
    """Four laps of 1.885 m in 199 steps of 1 ms; the speed is that along the chords."""
    path = written(tmp_path / "elsewhere.csv", circle(4.0), period_ms=1)
    ended = symolo("rerender", path, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "column t: the robot moves at 37.9 m/s" in ended.err
    assert "looks like seconds: multiply it by 1000" in ended.err
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("period_ms", [4, 50, 60_000])
def test_slow_and_quick_drives_are_left_alone(period_ms, tmp_path, prepared):
    prepared(written(tmp_path / "data.csv", circle(), period_ms), LOOK)


def test_times_in_fractions_of_a_second_are_one_clear_line(tmp_path, symolo):
    path = written(tmp_path / "elsewhere.csv", circle())
    header, *lines = path.read_text().splitlines()
    seconds = [f"{int(line.partition(',')[0]) / 1000:.3f},{line.partition(',')[2]}" for line in lines]
    path.write_text("\n".join((header, *seconds)) + "\n")
    ended = symolo("rerender", path, "--look", "lab", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert f"{path}:3: column t: 0.05 ms is not a millisecond after 0 ms" in ended.err
    assert "looks like seconds: multiply it by 1000" in ended.err


@pytest.mark.parametrize(("camera_hz", "images", "warns"), [(60.0, ROWS, True), (20.0, ROWS, False), (5.0, 50, False)])
def test_more_images_a_second_than_the_log_has_poses_are_a_warning(camera_hz, images, warns, tmp_path, symolo):
    """The log has a row each 50 ms."""
    path = written(tmp_path / "log.csv", circle())
    ended = symolo("rerender", path, "--look", "lab", "--camera-hz", camera_hz, "--dry-run", "--out", tmp_path / "out")
    assert (ended.code, f"{images} images; nothing was rendered" in ended.out) == (0, True)
    text = "warning: imported/test_1: the images are to be taken at 60 Hz, but the log usually has 20 poses a second"
    assert (text in ended.out, "import the log with --row-hz 60" in ended.out) == (warns, warns)


@pytest.mark.parametrize(("camera_hz", "apart"), [(15.0, "50 to 100 ms apart, and not 66.7 ms (15 Hz)"), (1.9, "")])
def test_images_at_poses_that_are_not_a_period_apart_are_a_warning(camera_hz, apart, tmp_path, symolo):
    """The log has a row each 50 ms: the first ones after multiples of 66.7 ms are at 0, 100, 150, 200, 300..."""
    path = written(tmp_path / "log.csv", circle())
    command = ("rerender", path, "--look", "lab", "--camera-hz", camera_hz, "--dry-run", "--out", tmp_path / "out")
    ended = symolo(*command)
    text = f"each image is at a pose of the log, which usually has 20 poses a second: the images are {apart}"
    assert ended.code == 0
    assert (text in ended.out) == bool(apart)
    assert ("import the log with --row-hz 15" in ended.out) == bool(apart)
    assert "ms apart" not in symolo(*command, "--row-hz", camera_hz).out
