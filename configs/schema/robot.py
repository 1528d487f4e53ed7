"""The robot: body, drive and sensors. R is the frame at the middle of the axle, x forward, y left."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, model_validator

from configs.effects.base import Effect
from configs.effects.robot_effects import RobotEffects, UnloadedEffect
from configs.robot_sensors import KNOWN_ONLY, RobotSensors, unloaded_settings
from configs.schema.base import FromList, Section, Slug, absent
from configs.schema.code_file import CodeFile
from configs.schema.controller import Controller
from configs.schema.effect_range import EffectRange
from configs.schema.field_of_view import with_focal_length
from configs.schema.mesh import MeshFile
from configs.user_files import EFFECT_FILES, SENSOR_FILES, with_unloaded_apart

Share = Annotated[float, Field(ge=0, le=1)]


class Chassis(Section):
    """A box centred on the axle that encloses the wheels, so that its footprint is that of the robot."""

    length_m: float = Field(ge=0.05, le=1)
    """Length of the box [m]."""
    width_m: float = Field(ge=0.05, le=1)
    """Width of the box, wheels included [m]."""
    clearance_m: float = Field(ge=0.002, le=0.2)
    """Height of the chassis' underside above the floor."""
    base_height_m: float = Field(ge=0.01, le=0.5)
    """Height of the base plate's top above the floor, from which the height of the camera is measured."""
    mass_kg: float = Field(gt=0.05, le=20)
    """Mass of the robot without its wheels [kg]."""
    center_of_mass_x_m: float = Field(ge=-0.2, le=0.2)
    """Centre of that mass ahead of the axle [m]."""
    center_of_mass_z_m: float = Field(ge=0.0, le=0.5)
    """Height of that centre above the floor [m]."""


class Drive(Section):
    """The two driven wheels and the caster."""

    track_m: float = Field(ge=0.03, le=1)
    """Distance b between the two ground contact points (paper Eq. 2)."""
    wheel_diameter_m: float = Field(ge=0.01, le=0.5)
    """Diameter of the wheels [m]."""
    wheel_width_m: float = Field(ge=0.002, le=0.1)
    """Width of the wheels [m]."""
    wheel_mass_kg: float = Field(gt=0, le=2)
    """Mass of one wheel [kg]."""
    wheel_friction: float = Field(ge=0, le=2)
    """Coulomb friction coefficient between tyre and floor."""
    caster_x_m: float = Field(ge=-0.5, le=0.5)
    """Place of the caster ahead of the axle [m]; below 0 it is behind."""
    caster_radius_m: float = Field(ge=0.002, le=0.1)
    """Radius of the caster's ball [m]."""
    caster_friction: float = Field(ge=0, le=2)
    """Coulomb coefficient between caster and floor; small for a ball that rolls."""


class Motor(Section):
    """Paper Eq. 15-21 with the inductance neglected; all parameters at the wheel shaft."""

    winding_resistance_ohm: float = Field(gt=0, le=1000)
    """Resistance of the winding [ohm]."""
    torque_constant_N_m_A: float = Field(gt=0, le=100)
    """Torque constant, which is also the back-EMF constant in V s/rad."""
    viscous_friction_N_m_s_rad: float = Field(ge=0, le=10)
    """Friction torque per speed [N m s/rad]."""
    coulomb_friction_N_m: float = Field(ge=0, le=10)
    """Friction torque at any speed [N m]."""
    rotor_inertia_kg_m2: float = Field(ge=0, le=1)
    """Inertia of rotor and gearbox, reflected to the wheel shaft."""
    motor_side_inertia_fraction: float = Field(default=0.9, ge=0.01, le=0.99)
    """Share of the rotor inertia on the motor side of the gearbox's play; used only with the effect `gear_backlash`."""
    motor_side_friction_fraction: float = Field(default=0.5, ge=0, le=1)
    """Share of all friction on the motor side of the gearbox's play; used only with the effect `gear_backlash`."""


class Power(Section):
    """Battery and motor driver."""

    battery_voltage_V: float = Field(gt=0, le=60)
    """Voltage of the battery without load [V]."""
    motor_voltage_limit_V: float = Field(gt=0, le=60)
    """Largest voltage that the H-bridge applies, at any battery voltage."""


class Encoder(Section):
    """Incremental encoders of the wheels."""

    counts_per_revolution: int = Field(ge=4, le=1_000_000)
    """Counts per turn of the wheel, all edges counted."""
    period_s: float = Field(gt=0, le=1)
    """Time between readings of the controller [s]; the wheel loop reads the counts undelayed, at
    `rates.wheel_loop_hz`."""
    delay_s: float = Field(ge=0, le=1)
    """Age of a reading when the controller receives it [s]."""
    dropout_probability: float = Field(ge=0, le=1)
    """Probability that a reading fails, so that the controller keeps the previous one."""


class WheelLoop(Section):
    """Wheel-speed controller on the encoder counts, one per wheel: feed-forward plus PI on the speed error."""

    speed_filter_s: float = Field(ge=0, le=1)
    """Time constant of the low-pass filter on the measured speed [s]; 0 for none."""
    feedforward_V_s_rad: float = Field(ge=0, le=10)
    """Voltage per set speed [V s/rad]."""
    feedforward_static_V: float = Field(ge=0, le=10)
    """Voltage against Coulomb friction, with the sign of the set speed [V]."""
    proportional_V_s_rad: float = Field(ge=0, le=10)
    """Voltage per speed error [V s/rad]."""
    integral_V_rad: float = Field(ge=0, le=100)
    """Voltage per integral of the speed error [V/rad]."""


class LineSensor(Section):
    """QTR-8A: a row of reflectance channels across the robot, L0 at the robot's right end, L7 at its left."""

    x_m: float = Field(ge=-0.5, le=0.5)
    """Place of the row ahead of the axle [m]."""
    height_m: float = Field(ge=0.0005, le=0.05)
    """Height of the sensors above the floor [m]."""
    channels: Literal[8] = 8
    """Number of channels, as in SyMoLo's columns L0 to L7."""
    pitch_m: float = Field(ge=0.001, le=0.05)
    """Distance between neighbouring channels [m]."""
    spot_diameter_at_floor_m: float = Field(ge=0, le=0.05)
    """Diameter of one channel's spot at zero height."""
    spot_growth: float = Field(ge=0, le=5)
    """Growth of the spot's diameter per metre of height [m/m]."""
    period_s: float = Field(gt=0, le=1)
    """Time between readings [s]."""
    delay_s: float = Field(ge=0, le=1)
    """Age of a reading when the controller receives it [s]."""
    gain_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the channels' gains, drawn once per run."""
    offset_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the channels' offsets, drawn once per run; 1 is full scale."""
    noise_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the noise of each reading; 1 is full scale."""
    adc_bits: int = Field(ge=1, le=16)
    """Resolution of the converter [bit]."""
    threshold: float = Field(gt=0, lt=1)
    """Reading below which a channel is on the line."""
    dropout_probability: float = Field(ge=0, le=1)
    """Probability that a reading fails, so that the previous one stands."""


class TofMount(Section):
    """Place and direction of one range sensor on the robot."""

    x_m: float = Field(ge=-0.5, le=0.5)
    """Place ahead of the axle [m]."""
    y_m: float = Field(ge=-0.5, le=0.5)
    """Place to the left of the robot's middle [m]."""
    z_m: float = Field(ge=0.005, le=1)
    """Height above the floor [m]."""
    yaw_deg: float = Field(ge=-180, le=180)
    """Direction of the beam to the left of straight ahead."""
    pitch_up_deg: float = Field(default=0.0, ge=-45, le=45)
    """Direction of the beam above the horizon."""


class TofMounts(Section):
    """Place and direction of the three range sensors."""

    front: TofMount
    """Mounting of the front sensor, column d_f."""
    left: TofMount
    """Mounting of the left sensor, column d_l; in the robot `nominal`, 45 degrees to the left."""
    right: TofMount
    """Mounting of the right sensor, column d_r; in the robot `nominal`, 45 degrees to the right."""


class RangeBeam(Section):
    """Beam, limits and errors of a VL53L0X."""

    rays: int = Field(ge=1, le=1000)
    """Number of rays in the cone."""
    field_of_view_deg: float = Field(gt=0, le=90)
    """Full angle of the cone."""
    beam_sigma_deg: float = Field(gt=0, le=90)
    """Standard deviation of the Gaussian beam profile that weighs the rays."""
    signal_threshold: float = Field(ge=0, le=1)
    """Light that returns, weighted by the beam, relative to a flat wall head-on that fills the cone; below this share
    there is no target. Reflectance and distance do not count."""
    period_s: float = Field(gt=0, le=1)
    """Time between readings [s]."""
    delay_s: float = Field(ge=0, le=1)
    """Age of a reading when the controller receives it [s]."""
    min_range_m: float = Field(ge=0, le=1)
    """Smallest range that the device reports [m]; below it there is no target."""
    max_range_m: float = Field(gt=0, le=10)
    """Largest range that the device reports [m]; beyond it there is no target."""
    no_target_m: float = Field(ge=0, le=10)
    """Range in data.csv when the device reports "no target"."""
    error_scale: float = Field(ge=-2, le=2)
    """Factor on Eq. 24 in the form 59.77 mm ln(x / 0.18 m) (docs/sensors.md)."""
    noise_scale: float = Field(ge=0, le=10)
    """Factor on the standard deviation of the noise (Eq. 23, and per surface Tables 3 and 4; docs/sensors.md has the
    formula), which is 0.8 to 1.8 mm at 0.1 m by surface and grows to about 4 mm at 0.6 m; 0 for no noise."""
    quantisation_m: float = Field(ge=0, le=0.1)
    """Step of the readings [m]; 0 for none."""
    temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature of the device; used only with the effect `temperature_drift`."""
    reference_temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature at which the device was calibrated."""
    ambient_lux: float = Field(default=500.0, ge=0, le=200_000)
    """Illuminance at the device; used only with the effect `ambient_noise`."""
    dropout_probability: float = Field(ge=0, le=1)
    """Probability that a reading fails, so that the previous one stands."""


class TofSensor(RangeBeam):
    """VL53L0X: rays over a cone, weighted mean, then error and noise (paper section 5.2, Eq. 23-24)."""

    mounts: TofMounts
    """Place and direction of each of the three sensors on the robot."""


class LensDistortion(Section):
    """Radial (k) and tangential (p) distortion in OpenCV's model; all 0 is a pinhole."""

    k1: float = Field(default=0.0, ge=-1, le=1)
    """Radial coefficient; below 0 barrel, above 0 pincushion."""
    k2: float = Field(default=0.0, ge=-1, le=1)
    """Radial coefficient of the fourth power of the radius."""
    p1: float = Field(default=0.0, ge=-0.1, le=0.1)
    """First tangential coefficient."""
    p2: float = Field(default=0.0, ge=-0.1, le=0.1)
    """Second tangential coefficient."""
    k3: float = Field(default=0.0, ge=-1, le=1)
    """Radial coefficient of the sixth power of the radius."""


class FisheyeLens(Section):
    """Fisheye lens in OpenCV's model; equidistant with all coefficients at 0."""

    field_of_view_deg: float = Field(default=185.0, ge=10, le=300)
    """Angle that the width of the image spans. The image is dark beyond it."""
    k1: float = Field(default=0.0, ge=-1, le=1)
    """Coefficient of the square of the angle in rad."""
    k2: float = Field(default=0.0, ge=-1, le=1)
    """Coefficient of its fourth power."""
    k3: float = Field(default=0.0, ge=-1, le=1)
    """Coefficient of its sixth power."""
    k4: float = Field(default=0.0, ge=-1, le=1)
    """Coefficient of its eighth power."""


class Camera(Section):
    """Camera that looks forward and down; heights are measured from the base plate (paper section 8.1)."""

    x_m: float = Field(ge=-0.5, le=0.5)
    """Place of the lens ahead of the axle [m]."""
    y_m: float = Field(ge=-0.5, le=0.5)
    """Place of the lens to the left of the robot's middle [m]."""
    height_above_base_m: float = Field(ge=-0.5, le=2)
    """Height of the lens above the base plate's top [m]; below 0 it is below, but above the floor."""
    pitch_down_deg: float = Field(ge=-90, le=90)
    """Angle of the optical axis below the horizon: 90 degrees minus the paper's 60 degrees from straight down."""
    yaw_left_deg: float = Field(default=0.0, ge=-180, le=180)
    """Angle of the optical axis to the left of straight ahead."""
    roll_deg: float = Field(default=0.0, ge=-180, le=180)
    """Rotation about the optical axis, clockwise as seen from behind the camera."""
    focal_length_mm: float = Field(ge=1, le=500)
    """Focal length of the lens; with `sensor_width_mm` it gives the horizontal field of view, 2 atan(sensor width /
    (2 focal length))."""
    field_of_view_deg: float | None = Field(default_factory=absent, gt=0, lt=180, exclude=True)
    """Horizontal field of view in the place of `focal_length_mm`, which follows from it and from `sensor_width_mm`."""
    sensor_width_mm: float = Field(ge=1, le=100)
    """Width of the image sensor [mm]."""
    principal_point_right_mm: float = Field(default=0.0, ge=-10, le=10)
    """Offset of the optical axis from the middle of the sensor, to the right in the image."""
    principal_point_down_mm: float = Field(default=0.0, ge=-10, le=10)
    """Offset of the optical axis from the middle of the sensor, downwards in the image."""
    distortion: LensDistortion = LensDistortion()
    fisheye: FisheyeLens | None = Field(default_factory=absent, exclude_if=lambda lens: lens is None)
    """Fisheye lens in the place of `focal_length_mm`, `sensor_width_mm` and `distortion`."""
    read_out_s: float = Field(default=0.0, ge=0, le=0.1)
    """Rolling shutter: delay of the exposure of the image's bottom after its top; 0 is a global shutter."""
    sees_robot: bool = Field(default=False, exclude_if=lambda sees: not sees)
    """Whether images show the robot's body, without the camera; they always show its shadow."""

    _focal_length = model_validator(mode="before")(with_focal_length)


class RobotBody(Section):
    """Shape of the chassis from a mesh file, in place of a plate and boxes; wheels and sensors stay as they are.

    The axes of the file are those of R: x forward, and after `mesh.up` z upwards.
    """

    mesh: MeshFile
    """File of the shape; contacts are those of its convex hull."""
    x_m: float = Field(default=0.0, ge=-1, le=1)
    """Origin of the file ahead of the axle [m]."""
    z_m: float = Field(default=0.0, ge=-1, le=1)
    """Origin of the file above the floor [m]."""
    color: Annotated[tuple[Share, Share, Share], FromList] = (0.05, 0.1, 0.35)
    """Reflectance of the body: red, green and blue, 0 black, 1 white."""


class RobotConfig(Section):
    """Body, drive, sensors and controller of the robot."""

    name: Slug
    """Name of the robot."""
    description: str = ""
    """Description for people."""
    chassis: Chassis
    body: RobotBody | None = Field(default_factory=absent, exclude_if=lambda body: body is None)
    """Shape of the chassis; without it, the robot has a plate with boxes."""
    drive: Drive
    motor: Motor
    power: Power
    encoder: Encoder
    wheel_loop: WheelLoop
    line_sensor: LineSensor
    tof: TofSensor
    camera: Camera
    controller: Controller
    sensors: RobotSensors = Field(default_factory=RobotSensors, exclude_if=lambda sensors: not sensors)
    """Sensors beside line sensor, range sensors and encoders; each has its table in `side/`."""
    effects: RobotEffects = Field(default_factory=RobotEffects, json_schema_extra={"default": {}})
    """Deviations of the real robot from the values above, which its controller does not know."""
    effect_files: Annotated[tuple[CodeFile, ...], FromList] = Field(default=(), exclude_if=lambda files: not files)
    """Python files with effects of your own, relative to the YAML file that names them."""
    sensor_files: Annotated[tuple[CodeFile, ...], FromList] = Field(default=(), exclude_if=lambda files: not files)
    """Python files with sensors of your own, relative to the YAML file that names them."""
    effect_ranges: Annotated[tuple[EffectRange, ...], FromList] = Field(
        default=(), exclude_if=lambda ranges: not ranges
    )
    """Ranges in which the effects were observed, as `symolo diagnose` writes them; a run that leaves them gets a
    warning."""

    @model_validator(mode="before")
    @classmethod
    def _unloaded_apart(cls, values: Any, info: ValidationInfo) -> Any:  # noqa: ANN401 - whatever a file holds
        known_only = info.context == KNOWN_ONLY
        values = with_unloaded_apart(values, EFFECT_FILES, UnloadedEffect, known_only=known_only)
        return with_unloaded_apart(values, SENSOR_FILES, unloaded_settings, known_only=known_only)

    def with_effect(self, effect: Effect) -> "RobotConfig":
        """Return this robot with one more effect, for example `SupplySag(source_resistance_ohm=0.4)`."""
        return self.model_copy(update={"effects": self.effects.with_effect(effect)})

    def with_section(self, name: str, values: Mapping[str, Any]) -> "RobotConfig":
        """Return this robot with other values in one of its sections; they are not validated again."""
        return self.model_copy(update={name: getattr(self, name).model_copy(update=values)})
