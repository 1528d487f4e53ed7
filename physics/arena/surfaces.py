"""Bias and noise of a range reading on each surface at 100 mm (paper Tables 3 and 4).

Range sensor and image use the same names: `blender_scenes.materials` has a function for each key here.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class RangeSurface:
    """How a range sensor reads one surface."""

    mean_mm_at_100_mm: float
    sd_mm_at_100_mm: float
    reflectance: float
    """Reflectance at the sensor's 940 nm. Not from the paper: usual values of such surfaces."""

    @property
    def offset_m(self) -> float:
        return 1e-3 * (self.mean_mm_at_100_mm - 100.0)


# The paper measured neither cardboard nor plywood nor brick. Cardboard is treated as paper, plywood as wood.
# Brick, matt and grainy as paper is, is treated as paper too: an assumption without a measurement.
SURFACES: dict[str, RangeSurface] = {
    "white_board": RangeSurface(100.25, 0.84, 0.85),
    "light_grey_board": RangeSurface(100.21, 0.82, 0.5),
    "dark_grey_board": RangeSurface(101.24, 0.79, 0.18),
    "black_board": RangeSurface(95.63, 0.80, 0.05),
    "metal": RangeSurface(89.06, 1.28, 0.7),
    "wood": RangeSurface(99.88, 1.42, 0.45),
    "plywood": RangeSurface(99.88, 1.42, 0.5),
    "glass": RangeSurface(96.58, 1.77, 0.1),
    "paper": RangeSurface(101.42, 1.45, 0.85),
    "cardboard": RangeSurface(101.42, 1.45, 0.55),
    "plastic": RangeSurface(99.7, 1.31, 0.6),
    "brick": RangeSurface(101.42, 1.45, 0.4),
}
