"""Figures that the paper prints for its five experiments, so that the model is not judged by its own figures."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians, tan
from types import MappingProxyType

from configs.schema.arena import SurfaceName


@dataclass(frozen=True)
class PrintedReadings:
    """Mean and standard deviation of readings, as printed."""

    mean_mm: float
    sd_mm: float


TABLE_3: Mapping[SurfaceName, PrintedReadings] = MappingProxyType(
    {
        "white_board": PrintedReadings(100.25, 0.84),
        "light_grey_board": PrintedReadings(100.21, 0.82),
        "dark_grey_board": PrintedReadings(101.24, 0.79),
        "black_board": PrintedReadings(95.63, 0.80),
    }
)
"""Readings at 100 mm from paper of four tones."""

TABLE_4: Mapping[SurfaceName, PrintedReadings] = MappingProxyType(
    {
        "metal": PrintedReadings(89.06, 1.28),
        "wood": PrintedReadings(99.88, 1.42),
        "glass": PrintedReadings(96.58, 1.77),
        "paper": PrintedReadings(101.42, 1.45),
        "plastic": PrintedReadings(99.70, 1.31),
    }
)
"""Readings at 100 mm from five materials."""

MEAN_WITHIN_MM = 0.5
SD_WITHIN = 0.15

HALF_ANGLE_DEG = 12.5
"""Half of the field of view, by the datasheet."""
STEP_HEIGHT_MM = 106.0
DISTANCES_MM = (50.0, 100.0, 150.0, 200.0, 250.0, 300.0)
"""Distances of experiments 3 and 4, where the paper names six from 50 to 300 mm."""
FIELD_OF_VIEW_MM = (50.0, 70.0, 90.0, 100.0, 130.0, 150.0)
"""Distances of experiment 5 (Fig. 19)."""


def footprint_mm(distance_mm: float) -> float:
    """Return the diameter of the field of view, 2 d tan 12.5 degrees, which the paper confirmed by camera images."""
    return 2.0 * distance_mm * tan(radians(HALF_ANGLE_DEG))
