"""Distance from the line's middle, against closed forms."""

import numpy as np
import pytest

from symolo.arena.geometry import Arc, Line, Straight
from symolo.report.statistics.off_line import ahead_of, off_line_m

STRAIGHT = Line((Straight((0.0, 0.0), (2.0, 0.0)),), 0.015, 0.05)
QUARTER = Line((Arc((0.0, 0.0), 1.0, 0.0, np.pi / 2),), 0.015, 0.05)


@pytest.mark.parametrize(
    ("line", "point", "expected_m"),
    [
        (STRAIGHT, (1.0, 0.3), 0.3),
        (STRAIGHT, (1.0, -0.3), 0.3),
        (STRAIGHT, (2.3, 0.4), 0.5),  # beyond the end: 3, 4, 5
        (STRAIGHT, (-0.6, 0.8), 1.0),
        (QUARTER, (0.5 * np.sqrt(0.5), 0.5 * np.sqrt(0.5)), 0.5),
        (QUARTER, (3.0, 4.0), 4.0),  # outside of the arc, seen from its centre
        (QUARTER, (-1.0, 0.0), np.sqrt(2.0)),  # nearest is its end (0, 1)
        (Line((*STRAIGHT.pieces, *QUARTER.pieces), 0.015, 0.05), (0.5, 0.1), 0.1),
    ],
)
def test_the_nearest_point_of_the_line_counts(line, point, expected_m):
    assert off_line_m(line, np.array([point])) == pytest.approx([expected_m], abs=1e-12)


def test_a_point_ahead_turns_with_the_robot():
    poses = np.array([[1.0, 2.0, 0.0], [1.0, 2.0, np.pi / 2], [1.0, 2.0, np.pi]])
    assert ahead_of(poses, 0.08) == pytest.approx(np.array([[1.08, 2.0], [1.0, 2.08], [0.92, 2.0]]))
