"""A rectified pair of cameras as a range sensor: disparities by OpenCV's semi-global matching.

Semi-global matching is that of Hirschmueller, "Stereo processing by semiglobal matching and mutual information", PAMI
2008, as OpenCV's `StereoSGBM` has it. A disparity of d pixels is a depth of f b / d.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.exporters.shared.stereo import cameras_with_images, stereo_pair
from symolo.reader.run import Run
from symolo.reader.run_folder import Pixels

NEAREST_M = 0.15
"""Smallest depth [m] that is matched, which sets the largest disparity."""
BLOCK_PX = 5
MIN_DISPARITY_PX = 1.5
EVERY_PX = 4
"""Distance of the pixels that are used, along rows and columns; neighbours have nearly the same disparity."""


@dataclass(frozen=True)
class StereoLog:
    """Pairs of images of a run, without their poses."""

    t_s: Array
    """(M,), times of the images [s]."""
    pixels: Callable[[int], tuple[Pixels, Pixels]]
    """Returns the i-th images of the left and the right camera, (H, W, 3), uint8 RGB."""
    K: Array
    """(3, 3), camera matrix of both cameras [px]."""
    X_RC: Array
    """(4, 4), pose of the left camera."""
    baseline_m: float

    @classmethod
    def from_run(cls, run: Run) -> "StereoLog | None":
        """Return the log of the first rectified pair of a run; None if there is none."""
        pair = stereo_pair(run)
        if pair is None:
            return None
        cameras = cameras_with_images(run)
        left, right = cameras[pair.left], cameras[pair.right]
        images = left.images, right.images
        return cls(
            np.array([image.t_s for image in images[0]]),
            lambda index: (images[0][index].pixels(), images[1][index].pixels()),
            left.camera.K,
            left.camera.X_RC,
            pair.baseline_m,
        )

    @property
    def focal_baseline_m_px(self) -> float:
        """Depth [m] times disparity [px]."""
        return float(self.K[0, 0]) * self.baseline_m

    def points(self, index: int) -> tuple[Array, Array]:
        """Return points in R (K, 3) [m] that a pair of images shows, and their depths (K,) [m]."""
        disparity_px = self.disparity_px(index)[EVERY_PX // 2 :: EVERY_PX, EVERY_PX // 2 :: EVERY_PX]
        row, column = (disparity_px >= MIN_DISPARITY_PX).nonzero()
        depth_m = self.focal_baseline_m_px / disparity_px[row, column]
        pixel = np.column_stack((column, row)) * EVERY_PX + EVERY_PX // 2
        rays_C = np.column_stack((pixel, np.ones(len(pixel)))) @ np.linalg.inv(self.K).T
        return depth_m[:, None] * rays_C @ self.X_RC[:3, :3].T + self.X_RC[:3, 3], depth_m

    def disparity_px(self, index: int) -> Array:
        """Return the disparity (H, W) [px] of a pair of images, below 0 where no match is certain."""
        import cv2  # noqa: PLC0415 - takes half a second, and most datasets have no stereo pair

        count = 16 * int(np.ceil(self.focal_baseline_m_px / NEAREST_M / 16))
        area = 3 * BLOCK_PX**2  # OpenCV's advice for the penalties: 8 and 32 times the number of values in a block
        matcher = cv2.StereoSGBM.create(
            minDisparity=0,
            numDisparities=count,
            blockSize=BLOCK_PX,
            P1=8 * area,
            P2=32 * area,
            disp12MaxDiff=1,
            uniquenessRatio=10,
            speckleWindowSize=100,
            speckleRange=2,
        )
        return matcher.compute(*self.pixels(index)) / 16.0
