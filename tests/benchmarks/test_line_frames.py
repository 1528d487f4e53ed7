"""Labels of the line benchmark against pinhole geometry worked out by hand."""

import importlib

import numpy as np
import pytest

from configs.schema.arena import ArenaConfig
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import Intrinsics

HEIGHT_M, FOCAL_PX = 0.2, 100.0
CAMERA = Intrinsics(160, 120, FOCAL_PX, FOCAL_PX, 79.5, 59.5, (0.0, 0.0, 0.0, 0.0, 0.0))
STRAIGHT_DOWN = np.array([[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, -1, HEIGHT_M], [0, 0, 0, 1.0]])
"""X_WC: the image's right is -y of W, its bottom -x, and it looks at the origin."""


@pytest.fixture
def line_frames():
    return importlib.import_module("line_frames")


def arena(start, end):
    pieces = [{"kind": "straight", "start": start, "end": end}]
    return Arena.from_config(ArenaConfig.model_validate({"name": "line", "line": {"pieces": pieces}}))


def test_a_line_seen_from_above_is_where_similar_triangles_say(line_frames):
    """2 cm to the left at 20 cm below, 100 px of focal length: 10 px left of the middle, in every row."""
    line_px = line_frames.centre_line(CAMERA, STRAIGHT_DOWN, arena((-1, 0.02), (1, 0.02)), line_frames.ROWS)
    assert line_px == pytest.approx([69.5, 69.5, 69.5], abs=1e-9)


def test_a_slanted_line_moves_a_pixel_per_pixel(line_frames):
    """x = y on the floor runs from the image's lower right to its upper left."""
    line_px = line_frames.centre_line(CAMERA, STRAIGHT_DOWN, arena((-1, -1), (1, 1)), line_frames.ROWS)
    assert line_px == pytest.approx([79.5 - 28, 79.5, 79.5 + 28], abs=1e-9)


def test_rows_that_a_line_does_not_reach_have_no_label(line_frames):
    """It begins at the middle of the image and goes on to its top."""
    line_px = line_frames.centre_line(CAMERA, STRAIGHT_DOWN, arena((0.02, 0), (1, 0)), line_frames.ROWS)
    assert line_px[0] == pytest.approx(79.5)
    assert np.isnan(line_px[1:]).all()


def test_rows_seen_alike_from_top_and_bottom(line_frames):
    assert np.allclose(np.array(line_frames.ROWS)[::-1], line_frames.HEIGHT_PX - 1 - np.array(line_frames.ROWS))
