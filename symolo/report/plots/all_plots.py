"""The pictures of the page."""

from collections.abc import Mapping
from dataclasses import dataclass

from symolo.report.state_sheets import Shown

A_FIGURE = 2
"""Maps side by side; the last figure may have fewer."""


@dataclass(frozen=True)
class Pictures:
    maps: tuple[bytes, ...]
    """SVG, of `A_FIGURE` maps each."""
    maps_in_all: int
    """How many there would be; some are left out of a release with many arenas."""
    runs: Mapping[str, bytes]
    """SVG of each run that is shown by itself, by name."""
    sheets: Mapping[int, tuple[Shown, ...]]
    """Which images are shown of each state."""
    images: Mapping[tuple[str, int], bytes]
    """JPEG of every image that is shown, by run and number."""
    brightness: bytes
    """SVG; empty where there is no image."""
    spread: bytes
    """SVG; empty where there is no image."""
    spread_of: int
    """Of how many runs that is."""
