"""The plots and images that the page shows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from symolo.report.camera_rows import CameraImage
from symolo.report.state_sheets import StateImage


@dataclass(frozen=True)
class Media:
    """All plots and images of the page, encoded."""

    maps: tuple[bytes, ...]
    """SVG of each map that is shown."""
    map_count: int
    """Number of maps of the release; a release with many arenas shows only some of them."""
    runs: Mapping[str, bytes]
    """SVG plot of each run that is shown in detail, by the name of the run."""
    state_sheets: Mapping[int, tuple[StateImage, ...]]
    """Images that are shown for each state."""
    images: Mapping[tuple[str, int], bytes]
    """JPEG of every image that is shown, by run and number."""
    brightness: bytes
    """SVG; empty if there is no image."""
    spread: bytes
    """SVG; empty if there is no image."""
    spread_runs: int
    """Number of runs in the plot `spread`."""
    sensors: Mapping[str, bytes] = field(default_factory=dict)
    """SVG plot of each sensor of `robot.sensors` in the run `sensor_run`, by the name of the sensor."""
    sensor_run: str = ""
    """Name of the run whose sensors and further cameras are shown."""
    scans: Mapping[str, bytes] = field(default_factory=dict)
    """SVG of the points that each lidar met in the run `sensor_run`, by the name of the sensor."""
    cameras: Sequence[Sequence[CameraImage]] = ()
    """Images of all cameras of the run `sensor_run`, a row for each moment; none without further cameras."""
