"""The index of a bag: its streams of numbers and images, as the child process prints it."""

from dataclasses import dataclass, field

from pydantic import TypeAdapter

MAX_STREAMS = 400
"""Number of streams that a bag may have; each is two arrays of an archive."""
POSE = ("px", "py", "pz", "qx", "qy", "qz", "qw")
"""Columns of a pose: position [m] and quaternion."""
IMU = tuple(f"{kind}_{axis}" for kind in ("acc", "gyro") for axis in "xyz")
"""Columns of an IMU: specific force [m/s2] and angular rate [rad/s]."""
SCAN = ("first_ray_rad", "ray_step_rad", "ray_s", "min_range_m", "max_range_m")
"""First columns of a laser scan; its ranges [m] and then its intensities follow, one for each ray."""
LENS = ("width_px", "height_px", *(f"K_{number}" for number in range(9)))
"""First columns of the lens of a camera: size of the image and camera matrix by rows; the distortion follows."""
RANGE, INTENSITY = "range", "intensity"
"""Names of the columns of the rays, each with the number of the ray."""


def ray_columns(name: str, rays: int) -> tuple[str, ...]:
    """Return the columns of a laser scan with one number for each ray."""
    return tuple(f"{name}_{number}" for number in range(rays))


@dataclass(frozen=True)
class Stream:
    """Messages of one topic with the same frames and columns."""

    topic: str
    type: str
    parent: str
    """Frame in which a pose is given, or frame of a sensor; empty where the message has none."""
    child: str
    """Frame whose pose it is, where the message names it; of a lens, the model of its distortion."""
    columns: tuple[str, ...]


@dataclass(frozen=True)
class ImageStream:
    """Images of one topic."""

    topic: str
    type: str
    frame: str
    problem: str = ""
    """Why they are not taken; empty where they are."""


@dataclass(frozen=True)
class Index:
    """The line that the child prints. The arrays `t<i>` (N,) [ns] and `v<i>` (N, columns) belong to the i-th stream.

    Of the i-th topic of images, `image_t<i>` (N,) [ns] are the times, `image_n<i>` (N,) the numbers of bytes of the
    files, and `image_v<i>` the bytes of all files.
    """

    streams: tuple[Stream, ...] = ()
    images: tuple[ImageStream, ...] = ()
    left_out: dict[str, str] = field(default_factory=dict)
    """Type of each topic that is not read."""
    error: str = ""
    """Why the bag cannot be read; empty where it can."""


INDEX = TypeAdapter(Index)

PROGRESS = "progress"
"""First word of a line with which the child reports how many messages of how many it has read."""
