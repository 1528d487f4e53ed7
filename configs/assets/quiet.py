"""OpenCV's decoder, whose own words about a damaged file stay unsaid: ours are one line."""

import cv2
import numpy as np
from numpy.typing import NDArray

_SILENT = 0


def decoded(data: bytes, flags: int) -> NDArray[np.generic] | None:
    """What OpenCV makes of a file's bytes, None where it refuses them."""
    before = cv2.getLogLevel()  # pyright: ignore[reportAttributeAccessIssue]
    cv2.setLogLevel(_SILENT)  # pyright: ignore[reportAttributeAccessIssue]
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error:
        return None
    finally:
        cv2.setLogLevel(before)  # pyright: ignore[reportAttributeAccessIssue]
