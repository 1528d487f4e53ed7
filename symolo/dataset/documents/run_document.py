"""side/spec.json for readers: only the fields on which tables, cameras, maps and exports depend.

The file has every number that the run was made from. A section can also be made from any object with the same
attributes, so that the program that makes a run can pass its specification.
"""

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from symolo.arena.mesh import unpacked
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.documents.origin import Origin
from symolo.dataset.documents.record import parsed_first
from symolo.dataset.rates import Rate

Point2 = tuple[float, float]
Positive = Annotated[float, Field(gt=0)]


class SpecSection(BaseModel):
    """A part of spec.json; fields that are not listed here are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True, from_attributes=True, allow_inf_nan=False)


class StraightSection(SpecSection):
    kind: Literal["straight"]
    start: Point2
    end: Point2
    joined: bool = False


class ArcSection(SpecSection):
    kind: Literal["arc"]
    center: Point2
    radius_m: float
    start_deg: float
    end_deg: float
    joined: bool = False


class LineSection(SpecSection):
    width_m: float
    reflectance: float
    pieces: tuple[Annotated[StraightSection | ArcSection, Field(discriminator="kind")], ...]


class FloorSection(SpecSection):
    half_extent_m: float
    reflectance: float


class WallSection(SpecSection):
    name: str
    start: Point2
    end: Point2
    height_m: float
    thickness_m: float
    surface: str


class WaypointSection(SpecSection):
    t_s: float
    offset: Point2
    turn_deg: float


class MotionSection(SpecSection):
    repeat: Literal["once", "loop", "back_and_forth"]
    waypoints: tuple[WaypointSection, ...]


def _checked(packed: str) -> str:
    unpacked(packed)
    return packed


class MeshSection(SpecSection):
    packed: Annotated[str, AfterValidator(_checked)]


class ObstacleSection(SpecSection):
    name: str
    center: Point2
    size: tuple[float, float, float]
    yaw_deg: float
    surface: str
    motion: MotionSection | None = None
    mesh: MeshSection | None = None
    solid: bool = True


class ArenaSection(SpecSection):
    name: str
    floor: FloorSection
    line: LineSection
    walls: tuple[WallSection, ...]
    obstacles: tuple[ObstacleSection, ...]


class ChassisSection(SpecSection):
    length_m: float
    width_m: float
    base_height_m: float


class DriveSection(SpecSection):
    wheel_diameter_m: Positive
    track_m: Positive


class EncoderSection(SpecSection):
    counts_per_revolution: int = Field(gt=0)


class LineSensorSection(SpecSection):
    x_m: float
    height_m: float


class TofMountSection(SpecSection):
    x_m: float
    y_m: float
    z_m: float
    yaw_deg: float
    pitch_up_deg: float


class TofMountsSection(SpecSection):
    front: TofMountSection
    left: TofMountSection
    right: TofMountSection


class TofSection(SpecSection):
    mounts: TofMountsSection
    field_of_view_deg: float
    min_range_m: float
    max_range_m: float
    no_target_m: float


class DistortionSection(SpecSection):
    k1: float
    k2: float
    p1: float
    p2: float
    k3: float


class FisheyeSection(SpecSection):
    field_of_view_deg: Positive
    k1: float
    k2: float
    k3: float
    k4: float


class CameraSection(SpecSection):
    x_m: float
    y_m: float
    height_above_base_m: float
    pitch_down_deg: float
    yaw_left_deg: float
    roll_deg: float
    focal_length_mm: Positive
    sensor_width_mm: Positive
    principal_point_right_mm: float
    principal_point_down_mm: float
    distortion: DistortionSection
    fisheye: FisheyeSection | None = None
    read_out_s: float


class SensorSection(SpecSection):
    """Settings of a sensor; a kind has more than those below."""

    model_config = ConfigDict(extra="allow", frozen=True, from_attributes=True, allow_inf_nan=False)

    kind: str = ""
    logged: bool = False
    """Whether its samples or images are those of a log, at times of their own."""
    period_s: Positive
    delay_s: float
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    yaw_deg: float = 0.0
    pitch_up_deg: float = 0.0
    roll_deg: float = 0.0


def _as_mapping(sensors: object) -> object:
    """Return the sensors of a complete config, which are pairs of name and settings, as a mapping."""
    return dict(sensors) if isinstance(sensors, Iterable) and not isinstance(sensors, str | list) else sensors


class RobotSection(SpecSection):
    name: str
    chassis: ChassisSection
    drive: DriveSection
    encoder: EncoderSection
    line_sensor: LineSensorSection
    tof: TofSection
    camera: CameraSection
    sensors: Annotated[dict[str, SensorSection], BeforeValidator(_as_mapping)] = Field(default_factory=dict)
    """Settings of the further sensors by name; metadata.json describes their tables."""


class ManualExposureSection(SpecSection):
    iso: float
    f_number: float


class LookCameraSection(SpecSection):
    exposure_time_s: float
    manual_exposure: ManualExposureSection | None = None
    """Settings of a manual exposure; None for an automatic one."""


class LookSection(SpecSection):
    name: str = ""
    camera: LookCameraSection


class RenderSection(SpecSection):
    width_px: int = Field(gt=0)
    height_px: int = Field(gt=0)
    annotations: tuple[AnnotationName, ...] = ()


class StartSection(SpecSection):
    x_m: float
    y_m: float
    yaw_deg: float


class RatesSection(SpecSection):
    physics_hz: int
    wheel_loop_hz: int
    control_hz: int
    camera_hz: Rate = Field(ge=0, le=1000)


class BoardSection(SpecSection):
    kind: str


class ImagingDocument(SpecSection):
    """The sections on which the images depend."""

    robot: RobotSection
    look: LookSection
    render: RenderSection


class RunDocument(ImagingDocument):
    """The content of spec.json."""

    scenario: str
    seed: int
    route: str
    run: int
    start: StartSection
    rates: RatesSection | None = None
    """Rates of the simulation; None if the trajectory was imported."""
    arena: ArenaSection
    board: BoardSection | None = None
    drawn: dict[str, float | int | str | bool]
    """Every value that was drawn for the run, by its field path in this document."""
    origin: Origin | None = None
    """Origin of the trajectory; None if it was simulated for this dataset."""

    _parsed = model_validator(mode="before")(parsed_first)

    @property
    def is_imported(self) -> bool:
        """Whether the trajectory was imported from a log."""
        return self.origin is not None and self.origin.log is not None

    @property
    def key(self) -> str:
        """Folder of the run in its dataset, for example `CW/test_1`."""
        return f"{self.route}/test_{self.run}"
