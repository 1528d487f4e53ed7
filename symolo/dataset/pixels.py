"""A picture of a dataset as it is stored."""

from pathlib import Path

import numpy as np


def decoded(path: Path) -> np.ndarray | None:
    """(H, W) or (H, W, 3), in OpenCV's order of channels and the file's own type; None for what is no picture."""
    import cv2  # noqa: PLC0415 - half a second that whoever reads tables does not need

    data = np.frombuffer(path.read_bytes() if path.is_file() else b"", dtype=np.uint8)
    try:
        return cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if len(data) else None
    except cv2.error:  # its head claims more pixels than OpenCV takes
        return None
