"""The camera of a run as arrays that numpy and OpenCV take."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics
from symolo.dataset.documents.camera_model import CameraDocument


@dataclass(frozen=True, eq=False)
class CalibratedCamera:
    """The camera of a run; its arrays are read-only."""

    document: CameraDocument
    """The content of side/intrinsics.json."""
    K: Array
    """(3, 3), camera matrix [px]; pixel (0, 0) is the middle of the first pixel."""
    D: Array
    """(5,), k1, k2, p1, p2, k3 of a pinhole camera, or (4,), k1, k2, k3, k4 of a fisheye lens, as in OpenCV."""
    X_RC: Array
    """(4, 4), pose of the camera on the robot [m]."""
    X_CB: Array
    """(4, 4), pose in C of the camera's body frame B: x forward, y left, z up."""

    def __post_init__(self) -> None:
        for array in (self.K, self.D, self.X_RC, self.X_CB):
            array.flags.writeable = False

    @classmethod
    def from_document(cls, document: CameraDocument) -> "CalibratedCamera":
        return cls(
            document, np.array(document.K), np.array(document.D), np.array(document.X_RC), np.array(document.X_CB)
        )

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
    def field_of_view_deg(self) -> float | None:
        """Angle within which a fisheye lens brings light to the sensor; None for a pinhole camera."""
        return self.document.field_of_view_deg

    @property
    def exposure_s(self) -> float:
        return self.document.exposure_s

    @property
    def iso(self) -> float | None:
        """ISO speed of a manual exposure; None for an automatic one."""
        return self.document.iso

    @property
    def f_number(self) -> float | None:
        """F-number of a manual exposure; None for an automatic one."""
        return self.document.f_number

    @property
    def read_out_s(self) -> float:
        """Time from the exposure of the first row to that of the row after the last; 0 for a global shutter."""
        return self.document.read_out_s

    @property
    def intrinsics(self) -> Intrinsics:
        """Intrinsics for the functions of `symolo.core.geometry.pinhole`."""
        return self.document.intrinsics
