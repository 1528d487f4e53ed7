"""A picture of a dataset as it is stored."""

from pathlib import Path

import numpy as np

from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE


def decoded(path: Path) -> np.ndarray | None:
    """(H, W) or (H, W, 3), in OpenCV's order of channels and the file's own type; None for what is no picture."""
    import cv2  # noqa: PLC0415 - half a second that whoever reads tables does not need

    try:
        data = np.frombuffer(read_file(path, FileKind.IMAGE), dtype=np.uint8)
    except NOT_THERE:
        return None
    try:
        return cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if len(data) else None
    except cv2.error:  # its head claims more pixels than OpenCV takes
        return None
