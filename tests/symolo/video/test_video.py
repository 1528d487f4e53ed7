"""A video shows each moment of the runs; independent readers find its frames, their times and their colours."""

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import cv2
import numpy as np
import pytest
from PIL import Image

from symolo.core.errors import InputError
from symolo.playback.from_run import playback_of
from symolo.playback.playback import CurvePlot, PlottedCurve
from symolo.reader.dataset import load
from symolo.video.build import Video, VideoSettings
from symolo.video.canvas import Canvas, text_width
from symolo.video.encoders import gif_chunks, mp4_chunks, webp_chunks
from symolo.video.floor import FloorView
from symolo.video.frames import RunFrames, times_s
from symolo.video.rows import row_at
from symolo.video.time_plots import TimePlot, ticks_around

SMALL = VideoSettings(width_px=320, fps=Fraction(5), speed=1.0, max_runs=12)
CAMERA = (slice(35, 50), slice(75, 90))
"""Pixels within the camera's picture in a frame of this size."""
ORANGE = (0xE6, 0x9F, 0x00)
"""Of state 5 (avoid by the left), in the colours of Okabe and Ito."""


@pytest.fixture(scope="module")
def root(painted):
    return painted()


@pytest.fixture(scope="module")
def film(root):
    return Video(load(root), SMALL).film()


@pytest.fixture(scope="module")
def mp4(film, tmp_path_factory):
    path = tmp_path_factory.mktemp("video") / "runs.mp4"
    path.write_bytes(b"".join(mp4_chunks(film)))
    return path


def test_times_include_the_first_and_the_last_row():
    rows_s = 0.05 * np.arange(41)
    assert times_s(rows_s, 5.0, 1.0) == pytest.approx([0.2 * k for k in range(11)])
    assert times_s(rows_s, 5.0, 4.0) == pytest.approx([0.0, 0.8, 1.6, 2.0])
    assert times_s(rows_s[:1], 5.0, 1.0) == [0.0]


def test_a_frame_shows_the_row_and_the_image_that_were_there_last():
    t_s = np.array([0.0, 0.2, 0.4])
    assert [row_at(t_s, now) for now in (-1.0, 0.0, 0.19, 0.2, 0.39999999, 9.0)] == [0, 0, 0, 1, 2, 2]


def test_each_run_is_shown_and_its_last_frame_stays_half_a_second(film):
    # 11 frames for two seconds at 5 Hz, then two or three more.
    assert film.count == 3 * (11 + round(0.5 * 5))


def test_the_camera_shows_the_image_of_the_moment(film):
    # The flat image n of the fixture has the grey value 120 + n, and the frame k is at 0.2 k s, as the image k + 1.
    for frame in (0, 4, 10):
        pixels = film.frame(frame)
        assert pixels.shape == (180, 320, 3)
        assert np.abs(pixels[CAMERA].astype(int) - (121 + frame)).max() <= 1


def test_several_cameras_have_their_names_in_a_corner_and_a_single_one_has_none(root):
    """The images are flat, so that a corner of one grey has no letters."""
    playback = playback_of(load(root).runs[0])
    (camera,) = playback.cameras
    pair = replace(playback, cameras=(replace(camera, name="left"), replace(camera, name="right")))
    alone, both = (RunFrames(one, "", 640, 360).at(0.0) for one in (playback, pair))

    def corner(part):
        rows, columns = np.nonzero((part == camera.images[0].pixels()[0, 0]).all(axis=2))
        return part[rows.min() : rows.min() + 16, columns.min() : columns.min() + 30]

    left, right = corner(both[:, :158]), corner(both[:, 166:324])
    assert np.ptp(corner(alone[:, :324])) == 0
    assert (left.max(), right.max(), left.min() < 60, right.min() < 60) == (255, 255, True, True)
    assert not np.array_equal(left, right)


def test_an_independent_reader_finds_the_frames_in_the_mp4(film, mp4):
    video = cv2.VideoCapture(str(mp4))
    assert int(video.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little") == b"h264"
    assert video.get(cv2.CAP_PROP_FPS) == 5.0
    frames = []
    while (read := video.read())[0]:
        frames.append(read[1][..., ::-1])
    assert len(frames) == film.count
    for number in (0, 10, 30):
        assert np.abs(frames[number][CAMERA].astype(int) - film.frame(number)[CAMERA]).mean() < 3
        assert np.abs(frames[number].astype(int) - film.frame(number)).mean() < 3


def test_the_index_of_the_mp4_comes_before_the_frames(mp4):
    data = mp4.read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_the_same_runs_give_the_same_bytes(root, mp4, film):
    again = Video(load(root), SMALL).film()
    assert b"".join(mp4_chunks(again)) == mp4.read_bytes()
    assert b"".join(gif_chunks(again)) == b"".join(gif_chunks(film))


@pytest.mark.parametrize(("encoder", "kind"), [(gif_chunks, "GIF"), (webp_chunks, "WEBP")])
def test_an_animation_lasts_as_long_as_the_video(film, tmp_path, encoder, kind):
    path = tmp_path / "animation"
    path.write_bytes(b"".join(encoder(film)))
    with Image.open(path) as animation:
        assert (animation.format, animation.size, animation.info["loop"]) == (kind, (320, 180), 0)
        lasts_ms, shown = 0, []
        for number in range(animation.n_frames):
            animation.seek(number)
            shown.append(np.asarray(animation.convert("RGB")))
            lasts_ms += animation.info["duration"]
    assert lasts_ms == round(1000 * film.count / 5)
    assert np.abs(shown[0].astype(int) - film.frame(0)).mean() < 4


def test_the_robot_is_where_its_pose_is(root):
    """From its colour alone: in the rows of state 5 it drives 11 times 10 mm towards -y, which is down."""
    run = load(root).runs[0]
    playback = playback_of(run)
    floor = FloorView(playback, 600, 600)
    first, last = (middle_of(floor.frame(row).pixels) for row in (20, 31))
    low, high = -1.05 - 0.0075 - 0.12, 0.90 + 0.02 + 0.12  # tape and wall A1 of the arena, and the margin around both
    pixels_per_m = 600 / (high - low)
    assert last[0] - first[0] == pytest.approx(0.0, abs=1.0)
    assert last[1] - first[1] == pytest.approx(0.11 * pixels_per_m, abs=2.0)
    assert first[1] == pytest.approx((high - -0.40) * pixels_per_m, abs=2.0)
    assert middle_of(floor.frame(20).pixels) == first, "frames may have any order"


def middle_of(pixels):
    """x and y of the middle of the area in the colour of state 5; thin lines are worn away."""
    area = (np.abs(pixels.astype(int) - ORANGE).max(axis=2) < 8).astype(np.uint8)
    rows, columns = np.nonzero(cv2.erode(area, np.ones((9, 9), np.uint8)))
    return (columns.min() + columns.max()) / 2, (rows.min() + rows.max()) / 2


@pytest.mark.parametrize(
    ("values", "from_zero", "ticks"),
    [
        ([0.0, 0.18], False, [0.0, 0.1, 0.2]),
        ([0.82, 0.86], True, [0.0, 0.5, 1.0]),
        ([np.nan, -2.3, 3.1], False, [-4.0, -2.0, 0.0, 2.0, 4.0]),
        ([np.nan, np.nan], False, [0.0, 0.5, 1.0]),
        ([0.2, 0.2], False, [0.0, 0.1, 0.2]),
        ([0.0, 0.0], False, [0.0, 0.5, 1.0]),
    ],
)
def test_ticks_are_round_numbers_around_the_values(values, from_zero, ticks):
    assert ticks_around(np.array(values), from_zero=from_zero) == pytest.approx(ticks)


def test_too_many_frames_for_a_format_are_refused(root):
    with pytest.raises(InputError, match=r"too many frames: got 39, allowed: up to 38 .*--fps"):
        Video(load(root), SMALL).check_length(38)


def test_without_the_extra_it_names_it_and_writes_nothing(root, tmp_path):
    code = "import sys; sys.modules['av'] = None\nfrom pipeline.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "video", root, "--out", tmp_path / "runs.mp4"]
    ended = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (5, 1)
    assert "install symolo with the extra `video`" in ended.stderr
    assert not list(tmp_path.iterdir())


def test_the_command_writes_the_video(root, tmp_path, symolo):
    out = tmp_path / "runs.gif"
    ended = symolo("video", root, "--out", out, "--width-px", 320, "--fps", 5, "--speed", 4, "--runs", "CW/*")
    assert ended.code == 0
    # Four frames for each of two runs, and the pauses.
    assert ended.out == f"{out}: 2 runs, {(2 * (4 + 2)) / 5:.1f} s, {out.stat().st_size / 1e6:.1f} MB\n"


class Texts:
    """The words that were drawn on a canvas, with the left end of each."""

    def __init__(self, monkeypatch):
        self.written = []
        write = Canvas.text

        def text(canvas, words, x, y, size_px, *colour):
            self.written.append((words, x, text_width(words, size_px)))
            return write(canvas, words, x, y, size_px, *colour)

        monkeypatch.setattr(Canvas, "text", text)


@pytest.mark.parametrize("size_px", [(300, 300), (500, 240), (160, 400)])
def test_the_scale_bar_is_as_long_as_its_label_says(root, size_px, monkeypatch):
    texts = Texts(monkeypatch)
    playback = playback_of(load(root).runs[0])
    pixels = FloorView(playback, *size_px).frame(0).pixels
    ((label, left, _),) = texts.written
    length_m = float(label.removesuffix(" m"))
    bottom = size_px[1] - 0.5 * 0.03 * size_px[1]
    rows = pixels[round(bottom) - 2 : round(bottom) + 2, : size_px[0] // 2]
    bar_px = np.flatnonzero(rows.min(axis=(0, 2)) < 170)
    # The whole window is the arena and the path with a margin, and the narrower side of it fills the picture.
    points = [playback.pose[:, :2], *(edge for pair in playback.arena.line.edges() for edge in pair)]
    points += [box.footprint() for box in playback.arena.boxes if box.motion is None]
    everything = np.concatenate(points)
    extent_m = np.ptp(everything, axis=0) + 2 * 0.12
    scale = min(size_px[0] / extent_m[0], size_px[1] / extent_m[1])
    assert bar_px[0] == pytest.approx(left, abs=2)
    assert np.ptp(bar_px) == pytest.approx(length_m * scale, abs=3)


def test_times_below_a_plot_stand_where_a_curve_has_them(monkeypatch):
    """The curve is 0 except for one row at 4 s, whose peak is drawn there."""
    texts = Texts(monkeypatch)
    t_s = np.arange(0, 10.01, 0.05)
    values = np.where(np.abs(t_s - 4) < 0.01, 1.0, 0.0)
    plot = CurvePlot("signal", "m", t_s, (PlottedCurve("signal", values, "#ff0000", "-"),))
    canvas = Canvas.blank(400, 120)
    TimePlot(plot, (0.0, 10.0), 400, 120, 10.0).draw(canvas, 0.0)
    middles = {words: left + 0.5 * width for words, left, width in texts.written if words in {"0", "5", "10 s"}}
    red = (canvas.pixels[..., 0] > 200) & (canvas.pixels[..., 1] < 90) & (canvas.pixels[..., 2] < 90)
    peak = np.flatnonzero(red[20:60].any(axis=0)).mean()
    assert peak == pytest.approx(middles["0"] + 4 / 5 * (middles["5"] - middles["0"]), abs=2)
