"""An arena from the image of a floor plan: what is dark is wall."""

import cv2
import numpy as np

from configs.arena_import.drawing import MAX_WALLS, Drawing
from configs.assets.images import MAX_BYTES, averaged_down, whole_image
from symolo.core.errors import InputError

DARK = 128
"""Grey level below which a pixel is wall."""
ROUGHNESS_PX = 1.5
"""Largest distance of an outline from the pixels that it follows."""
MIN_AREA_PX = 25.0
"""Area below which a dark spot is dirt."""


def drawing_from_image(data: bytes, where: str, width_m: float | None) -> Drawing:
    """Return the walls of a floor plan: the outlines of its dark areas.

    Args:
        data: Bytes of a PNG or JPEG file.
        where: The file, for messages.
        width_m: Width of the whole image.

    Raises:
        InputError: It is no such image, nothing is dark, or there are too many walls.
    """
    if width_m is None:
        raise InputError("the width of the image is not known", where=where, cure="add it in metres: --width-m 2.4")
    try:
        if len(data) > MAX_BYTES:
            raise ValueError(f"is larger than {MAX_BYTES >> 20} MiB")  # noqa: TRY301 - handled with the others
        image = averaged_down(whole_image(data))
    except ValueError as error:
        raise InputError(f"the image {error}", where=where, allowed="PNG or JPEG") from None
    dark = (cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) < DARK).astype(np.uint8)
    # A border of floor, so that a wall at the edge of the image has an outline there.
    framed = np.pad(dark, 1)
    outlines, tree = cv2.findContours(framed, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    drawing, metres = Drawing(), width_m / image.shape[1]
    # The tree has the next and the previous outline, the first one inside and the one around; it is None without any.
    parents: list[int] = np.asarray(tree).reshape(-1, 4)[:, 3].tolist() if outlines else []
    for outline, parent in zip(outlines, parents, strict=True):
        if cv2.contourArea(outline) < MIN_AREA_PX:
            drawing.ignored.append("a spot of a few pixels")
            continue
        corners = cv2.approxPolyDP(outline, ROUGHNESS_PX, closed=True)[:, 0].astype(float)
        if len(corners) < 3:
            drawing.ignored.append("a stroke without width")
            continue
        points = tuple((float(x - 0.5) * metres, -float(y - 0.5) * metres) for x, y in corners)
        # The outline of a dark area is outside of the robot; a hole in it is a room.
        (drawing.pillars if parent < 0 else drawing.rooms).append(points)
    if drawing.is_empty():
        raise InputError("nothing in the image is darker than middle grey", where=where, allowed="dark walls on white")
    if (walls := drawing.wall_count()) > MAX_WALLS:
        cure = "draw straight walls, or make the image coarser"
        raise InputError("walls", where=where, got=walls, allowed=f"at most {MAX_WALLS}", cure=cure)
    return drawing
