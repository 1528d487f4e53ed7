"""Rows at the images of a further camera, on an arc with a closed form."""

import numpy as np

from symolo.dataset.tables.camera_rows import rows_at_images
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
