"""Rows at the images of a camera whose images are between rows, on an arc with a closed form."""

import numpy as np
import pytest

from symolo.dataset.documents.run_records import RatesRecord
from symolo.dataset.tables.camera_rows import image_column, rows_at_images
from symolo.dataset.tables.rows import Rows

SPEED_M_S, RATE_RAD_S = 0.2, 1.6


def _arc(t_s):
    angle = RATE_RAD_S * t_s
    radius_m = SPEED_M_S / RATE_RAD_S
    return np.column_stack([radius_m * np.sin(angle), radius_m * (1 - np.cos(angle)), angle])


def test_a_camera_with_a_period_between_the_rows_has_the_poses_of_the_path():
    t_ms = 50 * np.arange(21)
    rows = Rows(
        t_ms=t_ms,
        pose=np.round(_arc(t_ms / 1000), 6),
        state=np.arange(21) // 7,
        twist=np.tile([SPEED_M_S, RATE_RAD_S], (21, 1)),
        tof_m=np.arange(63.0).reshape(21, 3),
        line=np.zeros((21, 8)),
        image=np.where(t_ms % 200 == 0, t_ms // 200 + 1, 0),
    )
    seen = rows_at_images(rows, 0.035)
    np.testing.assert_array_equal(seen.t_ms, 35 * np.arange(29))
    np.testing.assert_array_equal(seen.image, 1 + np.arange(29))
    np.testing.assert_allclose(seen.pose, _arc(seen.t_ms / 1000), atol=3e-6)
    np.testing.assert_array_equal(seen.pose, np.round(seen.pose, 6))
    np.testing.assert_array_equal(seen.state, (seen.t_ms // 50) // 7)
    np.testing.assert_array_equal(seen.tof_m[:, 0], 3.0 * (seen.t_ms // 50))
    np.testing.assert_allclose(seen.twist, np.tile([SPEED_M_S, RATE_RAD_S], (29, 1)))


@pytest.mark.parametrize(
    ("camera_hz", "column"),
    [
        # Images after 0, 33, 67, 100... ms: the second and the third are both nearest to the row at 50 ms.
        (30, [1, 2, 4, 5, 7, 8, 10]),
        # After 0, 143 and 286 ms.
        (7, [1, 0, 0, 2, 0, 0, 3]),
        # At every second row, as numbers of rows say.
        (10, [1, 0, 2, 0, 3, 0, 4]),
        # After 0, 400 ms and so on: only the first one is within the rows.
        (2.5, [1, 0, 0, 0, 0, 0, 0]),
    ],
)
def test_a_row_has_the_number_of_the_image_that_is_nearest_in_time(camera_hz, column):
    rates = RatesRecord(physics_hz=1000, wheel_loop_hz=100, control_hz=20, camera_hz=camera_hz)
    assert image_column(50 * np.arange(7), rates).tolist() == column
