"""The camera of a run as arrays that numpy and OpenCV take."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics
from symolo.dataset.documents.camera_model import CameraDocument


@dataclass(frozen=True)
class CalibratedCamera:
    document: CameraDocument
    """The content of side/intrinsics.json."""

    @property
    def K(self) -> Array:
        """(3, 3), camera matrix [px]; pixel (0, 0) is the middle of the first pixel."""
        return np.array(self.document.K)

    @property
    def D(self) -> Array:
        """(5,), k1, k2, p1, p2, k3 of a pinhole camera, or (4,), k1, k2, k3, k4 of a fisheye lens, as in OpenCV."""
        return np.array(self.document.D)

    @property
    def X_RC(self) -> Array:
        """(4, 4), pose of the camera on the robot [m]."""
        return np.array(self.document.X_RC)

    @property
    def X_CB(self) -> Array:
        """(4, 4), pose in C of the camera's body frame B: x forward, y left, z up."""
        return np.array(self.document.X_CB)

    @property
    def width_px(self) -> int:
        return self.document.width_px

    @property
    def height_px(self) -> int:
        return self.document.height_px

    @property
    def camera_model(self) -> str:
        """`pinhole` or `fisheye`."""
        return self.document.camera_model

    @property
    def distortion_model(self) -> str:
        """Name of D in ROS: `plumb_bob` or `equidistant`."""
        return self.document.distortion_model

    @property
    def exposure_s(self) -> float:
        return self.document.exposure_s

    @property
    def read_out_s(self) -> float:
        """Time from the exposure of the first row to that of the row after the last; 0 for a global shutter."""
        return self.document.read_out_s

    @property
    def intrinsics(self) -> Intrinsics:
        """Intrinsics for the functions of `symolo.core.geometry.pinhole`."""
        return self.document.intrinsics
