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
    """A straight piece of the line."""

    kind: Literal["straight"]
    start: Point2
    """First point: x, y [m] in W."""
    end: Point2
    """Last point: x, y [m] in W."""
    joined: bool = False
    """Whether the piece continues the piece before without a joint."""


class ArcSection(SpecSection):
    """A piece of the line that is an arc."""

    kind: Literal["arc"]
    center: Point2
    radius_m: float
    start_deg: float
    """Direction from the centre to the first point, counter-clockwise from +x."""
    end_deg: float
    """Direction from the centre to the last point; larger than `start_deg` for an arc to the left."""
    joined: bool = False
    """Whether the piece continues the piece before without a joint."""


class LineSection(SpecSection):
    """The line on the floor, piece by piece."""

    width_m: float
    reflectance: float
    """Reflectance at the wavelength of the line sensor, 0 to 1."""
    pieces: tuple[Annotated[StraightSection | ArcSection, Field(discriminator="kind")], ...]


class FloorSection(SpecSection):
    """The square floor around the origin of W."""

    half_extent_m: float
    """Half the side of the square."""
    reflectance: float
    """Reflectance at the wavelength of the line sensor, 0 to 1."""


class WallSection(SpecSection):
    """An upright wall between two points of the floor."""

    name: str
    start: Point2
    """First end: x, y [m] in W."""
    end: Point2
    """Second end: x, y [m] in W."""
    height_m: float
    thickness_m: float
    surface: str


class WaypointSection(SpecSection):
    """The place of a moving obstacle at one time."""

    t_s: float
    offset: Point2
    """Displacement since t = 0: x, y [m] in W."""
    turn_deg: float
    """Turn since t = 0, counter-clockwise."""


class MotionSection(SpecSection):
    """The path of a moving obstacle."""

    repeat: Literal["once", "loop", "back_and_forth"]
    """Motion after the last waypoint: none, the path again, or back and forth along it."""
    waypoints: tuple[WaypointSection, ...]


def _checked(packed: str) -> str:
    unpacked(packed)
    return packed


class MeshSection(SpecSection):
    """The triangles of an obstacle that is no box."""

    packed: Annotated[str, AfterValidator(_checked)]
    """Text with vertices and faces, which `symolo.arena.mesh.unpacked` reads."""


class ObstacleSection(SpecSection):
    """A box or another body on the floor."""

    name: str
    center: Point2
    """Middle of its footprint at t = 0: x, y [m] in W."""
    size: tuple[float, float, float]
    """Length, width and height [m]."""
    yaw_deg: float
    surface: str
    motion: MotionSection | None = None
    """Path of the obstacle; None if it stands still."""
    mesh: MeshSection | None = None
    """Triangles of the obstacle; None for a box."""
    solid: bool = True
    """Whether the robot touches it and range sensors see it; otherwise only images show it."""


class ArenaSection(SpecSection):
    """Floor, line, walls and obstacles."""

    name: str
    floor: FloorSection
    line: LineSection
    walls: tuple[WallSection, ...]
    obstacles: tuple[ObstacleSection, ...]


class ChassisSection(SpecSection):
    """Dimensions of the body of the robot."""

    length_m: float
    width_m: float
    base_height_m: float
    """Height of the top of the base plate above the floor."""


class DriveSection(SpecSection):
    """Dimensions of the driven wheels."""

    wheel_diameter_m: Positive
    track_m: Positive
    """Distance between the ground contacts of both wheels."""


class EncoderSection(SpecSection):
    """Resolution of the encoders of both wheels."""

    counts_per_revolution: int = Field(gt=0)


class LineSensorSection(SpecSection):
    """Place of the line sensor on the robot."""

    x_m: float
    """Distance ahead of the axle."""
    height_m: float
    """Height above the floor."""


class TofMountSection(SpecSection):
    """Place and direction of a ToF sensor in R."""

    x_m: float
    y_m: float
    z_m: float
    yaw_deg: float
    pitch_up_deg: float


class TofMountsSection(SpecSection):
    """Places and directions of the three ToF sensors."""

    front: TofMountSection
    left: TofMountSection
    right: TofMountSection


class TofSection(SpecSection):
    """The three ToF sensors, which are of the same type."""

    mounts: TofMountsSection
    field_of_view_deg: float
    min_range_m: float
    max_range_m: float
    no_target_m: float
    """Range in data.csv of a sensor that reports no target."""


class DistortionSection(SpecSection):
    """Distortion of a lens, the five coefficients of OpenCV."""

    k1: float
    k2: float
    p1: float
    p2: float
    k3: float


class FisheyeSection(SpecSection):
    """A fisheye lens, with the four coefficients of OpenCV's fisheye model."""

    field_of_view_deg: Positive
    k1: float
    k2: float
    k3: float
    k4: float


class CameraSection(SpecSection):
    """Place, direction, lens and shutter of the camera."""

    x_m: float
    """Distance ahead of the axle."""
    y_m: float
    """Distance to the left of the middle of the axle."""
    height_above_base_m: float
    """Height above the top of the base plate."""
    pitch_down_deg: float
    yaw_left_deg: float
    roll_deg: float
    focal_length_mm: Positive
    sensor_width_mm: Positive
    principal_point_right_mm: float
    """Place of the principal point right of the middle of the sensor."""
    principal_point_down_mm: float
    """Place of the principal point below the middle of the sensor."""
    distortion: DistortionSection
    fisheye: FisheyeSection | None = None
    """Fisheye lens; None for a lens with `distortion`."""
    read_out_s: float
    """Delay of the exposure of the last row after that of the first row; 0 for a global shutter."""


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
    """The description of the robot, without its effects."""

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
    """Sensitivity and aperture of a manual exposure."""

    iso: float
    f_number: float


class LookCameraSection(SpecSection):
    """Exposure of the images."""

    exposure_time_s: float
    manual_exposure: ManualExposureSection | None = None
    """Settings of a manual exposure; None for an automatic one."""


class LookSection(SpecSection):
    """Name of the look, and exposure of its images."""

    name: str = ""
    camera: LookCameraSection


class RenderSection(SpecSection):
    """Size of the images, and kinds of their annotations."""

    width_px: int = Field(gt=0)
    height_px: int = Field(gt=0)
    annotations: tuple[AnnotationName, ...] = ()


class StartSection(SpecSection):
    """Pose of the robot in W at the start of the run."""

    x_m: float
    y_m: float
    yaw_deg: float


class RatesSection(SpecSection):
    """Rates of the simulation, of its controllers and of the camera."""

    physics_hz: int
    wheel_loop_hz: int
    control_hz: int
    camera_hz: Rate = Field(ge=0, le=1000)
    """Rate of the images; 0 for a run without images."""


class BoardSection(SpecSection):
    """The controller board of a run with hardware in the loop."""

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
