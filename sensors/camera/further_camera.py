"""A further camera: its place, lens, size, rate and shutter. Its images are rendered after the simulation."""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, model_validator

from configs.checks.optics import optics_faults
from configs.robot_sensors import MountedSettings
from configs.schema.base import PLANNED, FromList, absent, disagreement
from configs.schema.field_of_view import SENSOR_WIDTH_MM, with_focal_length
from configs.schema.robot import FisheyeLens, LensDistortion
from configs.schema.scenario import RenderQuality
from configs.validation.faults import ConfigFault
from sensors.base import Reading, Sensor, World
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.documents.camera_specification import KIND


def _with_period(settings: Any) -> Any:  # noqa: ANN401 - whatever a file holds; pydantic checks it afterwards
    """Return the settings with the period that follows from the rate, if they have one."""
    if not isinstance(settings, dict) or (rate_hz := settings.get("rate_hz")) is None:
        return settings
    if "period_s" in settings:
        raise disagreement("rate_hz", rate_hz, "either rate_hz or period_s")
    if not isinstance(rate_hz, int | float) or isinstance(rate_hz, bool) or not 0.1 <= rate_hz <= 1000:
        return settings  # the field says what is allowed
    return {**{name: value for name, value in settings.items() if name != "rate_hz"}, "period_s": 1 / rate_hz}


class CameraSettings(MountedSettings):
    """Place, lens, size, rate and shutter of a further camera; it looks along its x axis."""

    period_s: Annotated[float, PLANNED] = Field(default=0.2, ge=0.001, le=10)
    """Time between two images; the times themselves are in whole milliseconds."""
    rate_hz: Annotated[float | None, PLANNED] = Field(default_factory=absent, ge=0.1, le=1000, exclude=True)
    """Number of images per second in the place of `period_s`."""
    z_m: float = Field(default=0.12, gt=0, le=2)
    """Height of the lens above the floor [m]."""
    width_px: Annotated[int, PLANNED] = Field(default=640, ge=16, le=8192)
    """Width of the images [px]."""
    height_px: Annotated[int, PLANNED] = Field(default=480, ge=16, le=8192)
    """Height of the images [px]."""
    focal_length_mm: float = Field(default=30.0, ge=1, le=500)
    """Focal length of the lens; a fisheye lens has its field of view in its place."""
    field_of_view_deg: float | None = Field(default_factory=absent, gt=0, lt=180, exclude=True)
    """Horizontal field of view in the place of `focal_length_mm`, which follows from it and from `sensor_width_mm`."""
    sensor_width_mm: float = Field(default=SENSOR_WIDTH_MM, ge=1, le=100)
    """Width of the image sensor [mm]."""
    principal_point_right_mm: float = Field(default=0.0, ge=-10, le=10)
    """Offset of the optical axis from the middle of the sensor, to the right in the image."""
    principal_point_down_mm: float = Field(default=0.0, ge=-10, le=10)
    """Offset of the optical axis from the middle of the sensor, downwards in the image."""
    distortion: LensDistortion = LensDistortion()
    fisheye: FisheyeLens | None = Field(default_factory=absent, exclude_if=lambda lens: lens is None)
    """Fisheye lens; without it, it is a pinhole camera with `distortion`."""
    read_out_s: float = Field(default=0.0, ge=0, le=0.1)
    """Rolling shutter: delay of the exposure of the image's bottom after its top; 0 is a global shutter."""
    exposure_time_s: float | None = Field(default=None, ge=0, le=0.1)
    """Exposure time of each pixel; without it, that of `look.camera`, as for the rest of the camera's response."""
    sees_robot: bool = False
    """Whether images show the robot's body, without this camera; they always show its shadow."""
    quality: RenderQuality | None = None
    """Quality of the images; without it, that of `render`."""
    annotations: Annotated[tuple[Annotated[AnnotationName, PLANNED], ...], FromList, PLANNED] | None = Field(
        default_factory=absent, exclude_if=lambda kinds: kinds is None
    )
    """Annotations of its images; without them, those of `render`."""

    _focal_length = model_validator(mode="before")(with_focal_length)
    _period = model_validator(mode="before")(_with_period)

    def faults(self) -> Iterator[ConfigFault]:
        yield from optics_faults(self, self.width_px, self.height_px)


class Camera(Sensor):
    """A further camera, whose images are in `cameras/<name>/`."""

    name = KIND
    Settings = CameraSettings
    is_rendered = True

    def sample(self, world: World) -> Reading:
        """Raise an error: the images are rendered after the simulation."""
        raise NotImplementedError
