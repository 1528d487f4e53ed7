"""Parts of the facts of a run in metadata.json: start, rates, board, controller, further cameras."""

from pydantic import Field, model_validator

from symolo.dataset.annotations import AnnotationName
from symolo.dataset.codes import BoardKind, FramingName
from symolo.dataset.documents.record import Record
from symolo.dataset.documents.rendering_record import RenderingRecord
from symolo.dataset.rates import Rate


class StartRecord(Record):
    """Pose of the robot in W at the start of a run."""

    x_m: float
    y_m: float
    yaw_deg: float


class RatesRecord(Record):
    """Rates of a run; those of physics, wheel loop and control divided by the next one are whole numbers."""

    physics_hz: int = Field(ge=1)
    wheel_loop_hz: int = Field(ge=1)
    control_hz: int = Field(ge=1)
    """Rate of the controller and of the rows of data.csv."""
    camera_hz: Rate = Field(ge=0, le=1000)
    """Rate of the images; if it does not divide control_hz, they are also between the rows. 0 if there are none."""

    @model_validator(mode="after")
    def _whole_multiples(self) -> "RatesRecord":
        if self.physics_hz % self.wheel_loop_hz or self.wheel_loop_hz % self.control_hz:
            raise ValueError("physics_hz must be a multiple of wheel_loop_hz, and this a multiple of control_hz")
        return self


class BoardRecord(Record):
    """The board that drove a run, and the faults on the line to it."""

    kind: BoardKind
    framing: FramingName
    bits_per_s: int
    actuation_delay_ticks: int
    firmware_id: str
    """First eight bytes of the SHA-256 of the sources of its firmware; empty if the board did not report it."""
    rows_unanswered: int
    """Number of rows without a command from the board."""
    events: dict[str, int]
    """Number of other faults on the line, by the column of side/board.csv."""


class ControllerRecord(Record):
    """The controller that drove a run in place of the built-in one."""

    name: str
    files: dict[str, str]
    """SHA-256 of its file; for a program that of each file in its command line, by its place there."""


class CameraRecord(Record):
    """A further camera of a run, whose images are in cameras/<name>/."""

    period_s: float = Field(gt=0)
    images: int
    image_width_px: int
    image_height_px: int
    render_device: str = "CPU"
    """Name in Cycles of the device that rendered the images; empty if they are those of a log."""
    rendering: RenderingRecord | None = Field(default=None, exclude_if=lambda rendering: rendering is None)
    """How the images were rendered; None in datasets of earlier versions."""
    annotations: tuple[AnnotationName, ...] = ()
