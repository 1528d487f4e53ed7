"""The field of view of a camera, which a file may have in the place of the focal length."""

import math
from typing import Any

from configs.schema.base import disagreement
from configs.validation.other_units import other_unit

SENSOR_WIDTH_MM = 42.33
"""Width of the image sensor of a further camera for which none is written [mm]."""
FOCAL_LENGTH_MM = (1.0, 500.0)
"""Shortest and longest focal length."""


def with_focal_length(settings: Any) -> Any:  # noqa: ANN401 - whatever a file holds; pydantic checks it afterwards
    """Return the settings of a camera with the focal length that follows from its field of view, if they have one.

    The width of the sensor spans the field of view: focal length = sensor width / (2 tan(field of view / 2)).

    Raises:
        PydanticCustomError: There are both, or the focal length is out of bounds.
    """
    if not isinstance(settings, dict) or settings.get("field_of_view_deg") is None:
        return settings
    angle_deg, width_mm = settings["field_of_view_deg"], settings.get("sensor_width_mm", SENSOR_WIDTH_MM)
    if "focal_length_mm" in settings:
        raise disagreement("field_of_view_deg", angle_deg, "either field_of_view_deg or focal_length_mm")
    if settings.get("fisheye") is not None:
        raise disagreement("field_of_view_deg", angle_deg, "fisheye.field_of_view_deg for a fisheye lens")
    if not (_is_number(angle_deg) and 0 < angle_deg < 180 and _is_number(width_mm)):
        return {"focal_length_mm": 30.0, **settings}  # the fault is that of another field
    focal_mm = width_mm / (2 * math.tan(math.radians(angle_deg) / 2))
    shortest, longest = FOCAL_LENGTH_MM
    if not shortest <= focal_mm <= longest:
        low, high = (math.degrees(2 * math.atan(width_mm / (2 * end))) for end in (longest, shortest))
        allowed = f"{low:.3g} to {high:.4g} degrees with sensor_width_mm {width_mm:g}"
        raise disagreement(
            "field_of_view_deg", angle_deg, allowed, other_unit("field_of_view_deg", angle_deg, low, high)
        )
    others = {name: value for name, value in settings.items() if name != "field_of_view_deg"}
    return {**others, "focal_length_mm": focal_mm}


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
