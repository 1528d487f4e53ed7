"""The robot: body, drive, sensors and controller. R is the frame at the middle of the axle, x forward, y left."""

from typing import Annotated, Literal

from pydantic import Field

from configs.effects.base import Effect
from configs.effects.robot_effects import RobotEffects
from configs.robot_sensors import RobotSensors
from configs.schema.base import FromList, Point2, Section, Slug


class Chassis(Section):
    """A box centred on the axle that encloses the wheels, so that its footprint is that of the robot."""

    length_m: float = Field(ge=0.05, le=1)
    width_m: float = Field(ge=0.05, le=1)
    clearance_m: float = Field(ge=0.002, le=0.2)
    """Height of the chassis' underside above the floor."""
    base_height_m: float = Field(ge=0.01, le=0.5)
    """Height of the base plate's top above the floor, from which the height of the camera is measured."""
    mass_kg: float = Field(gt=0.05, le=20)
    center_of_mass_x_m: float = Field(ge=-0.2, le=0.2)
    center_of_mass_z_m: float = Field(ge=0.0, le=0.5)


class Drive(Section):
    track_m: float = Field(ge=0.03, le=1)
    """Distance b between the two ground contact points (paper Eq. 2)."""
    wheel_diameter_m: float = Field(ge=0.01, le=0.5)
    wheel_width_m: float = Field(ge=0.002, le=0.1)
    wheel_mass_kg: float = Field(gt=0, le=2)
    wheel_friction: float = Field(ge=0, le=2)
    """Coulomb friction coefficient between tyre and floor."""
    caster_x_m: float = Field(ge=-0.5, le=0.5)
    caster_radius_m: float = Field(ge=0.002, le=0.1)
    caster_friction: float = Field(ge=0, le=2)


class Motor(Section):
    """Paper Eq. 15-21 with the inductance neglected; all parameters at the wheel shaft."""

    winding_resistance_ohm: float = Field(gt=0, le=1000)
    torque_constant_N_m_A: float = Field(gt=0, le=100)
    """Torque constant, which is also the back-EMF constant in V s/rad."""
    viscous_friction_N_m_s_rad: float = Field(ge=0, le=10)
    coulomb_friction_N_m: float = Field(ge=0, le=10)
    rotor_inertia_kg_m2: float = Field(ge=0, le=1)
    """Inertia of rotor and gearbox, reflected to the wheel shaft."""
    motor_side_inertia_fraction: float = Field(default=0.9, ge=0.01, le=0.99)
    """Share of the rotor inertia on the motor side of the gearbox's play; used only with the effect `gear_backlash`."""
    motor_side_friction_fraction: float = Field(default=0.5, ge=0, le=1)
    """Share of all friction on the motor side of the gearbox's play; used only with the effect `gear_backlash`."""


class Power(Section):
    battery_voltage_V: float = Field(gt=0, le=60)
    motor_voltage_limit_V: float = Field(gt=0, le=60)
    """Largest voltage that the H-bridge applies, at any battery voltage."""


class Encoder(Section):
    counts_per_revolution: int = Field(ge=4, le=1_000_000)
    period_s: float = Field(gt=0, le=1)
    """Period of the readings by the controller; the wheel loop reads at `rates.wheel_loop_hz`."""
    delay_s: float = Field(ge=0, le=1)
    dropout_probability: float = Field(ge=0, le=1)
    """Probability that a reading fails, so that the controller keeps the previous one."""


class WheelLoop(Section):
    """Wheel-speed controller on the encoder counts, one per wheel: feed-forward plus PI on the speed error."""

    speed_filter_s: float = Field(ge=0, le=1)
    feedforward_V_s_rad: float = Field(ge=0, le=10)
    feedforward_static_V: float = Field(ge=0, le=10)
    proportional_V_s_rad: float = Field(ge=0, le=10)
    integral_V_rad: float = Field(ge=0, le=100)


class LineSensor(Section):
    """QTR-8A: a row of reflectance channels across the robot, L0 at the robot's right end, L7 at its left."""

    x_m: float = Field(ge=-0.5, le=0.5)
    height_m: float = Field(ge=0.0005, le=0.05)
    channels: Literal[8] = 8
    pitch_m: float = Field(ge=0.001, le=0.05)
    spot_diameter_at_floor_m: float = Field(ge=0, le=0.05)
    """Diameter of one channel's spot at zero height."""
    spot_growth: float = Field(ge=0, le=5)
    """Growth of the spot's diameter per metre of height [m/m]."""
    period_s: float = Field(gt=0, le=1)
    delay_s: float = Field(ge=0, le=1)
    gain_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the channels' gains, drawn once per run."""
    offset_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the channels' offsets, drawn once per run; 1 is full scale."""
    noise_sd: float = Field(ge=0, le=0.5)
    """Standard deviation of the noise of each reading; 1 is full scale."""
    adc_bits: int = Field(ge=1, le=16)
    threshold: float = Field(gt=0, lt=1)
    """Reading below which a channel is on the line."""
    dropout_probability: float = Field(ge=0, le=1)


class TofMount(Section):
    x_m: float = Field(ge=-0.5, le=0.5)
    y_m: float = Field(ge=-0.5, le=0.5)
    z_m: float = Field(ge=0.005, le=1)
    yaw_deg: float = Field(ge=-180, le=180)
    pitch_up_deg: float = Field(default=0.0, ge=-45, le=45)


class TofMounts(Section):
    front: TofMount
    left: TofMount
    right: TofMount


class TofSensor(Section):
    """VL53L0X: rays over a cone, weighted mean, then error and noise (paper section 5.2, Eq. 23-24)."""

    mounts: TofMounts
    rays: int = Field(ge=1, le=1000)
    field_of_view_deg: float = Field(gt=0, le=90)
    beam_sigma_deg: float = Field(gt=0, le=90)
    """Standard deviation of the Gaussian beam profile that weighs the rays."""
    signal_threshold: float = Field(ge=0, le=1)
    """Weighted share of returned light, relative to a wall at right angles, below which there is no target."""
    period_s: float = Field(gt=0, le=1)
    delay_s: float = Field(ge=0, le=1)
    min_range_m: float = Field(ge=0, le=1)
    max_range_m: float = Field(gt=0, le=10)
    no_target_m: float = Field(ge=0, le=10)
    """Range in data.csv when the device reports "no target"."""
    error_scale: float = Field(ge=-2, le=2)
    """Factor on Eq. 24 in the form 59.77 mm ln(x / 0.18 m)."""
    noise_scale: float = Field(ge=0, le=10)
    """Factor on the standard deviation of the noise (Eq. 23, and per surface Tables 3 and 4); 0 for no noise."""
    quantisation_m: float = Field(ge=0, le=0.1)
    """Step of the readings [m]; 0 for none."""
    temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature of the device; used only with the effect `temperature_drift`."""
    reference_temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature at which the device was calibrated."""
    ambient_lux: float = Field(default=500.0, ge=0, le=200_000)
    """Illuminance at the device; used only with the effect `ambient_noise`."""
    dropout_probability: float = Field(ge=0, le=1)


class LensDistortion(Section):
    """Radial (k) and tangential (p) distortion in OpenCV's model; all 0 is a pinhole."""

    k1: float = Field(default=0.0, ge=-1, le=1)
    """Radial coefficient; below 0 barrel, above 0 pincushion."""
    k2: float = Field(default=0.0, ge=-1, le=1)
    p1: float = Field(default=0.0, ge=-0.1, le=0.1)
    p2: float = Field(default=0.0, ge=-0.1, le=0.1)
    k3: float = Field(default=0.0, ge=-1, le=1)


class Camera(Section):
    """Camera that looks forward and down; heights are measured from the base plate (paper section 8.1)."""

    x_m: float = Field(ge=-0.5, le=0.5)
    y_m: float = Field(ge=-0.5, le=0.5)
    height_above_base_m: float = Field(ge=0, le=1)
    pitch_down_deg: float = Field(ge=-10, le=90)
    """Angle of the optical axis below the horizon: 90 degrees minus the paper's 60 degrees from straight down."""
    yaw_left_deg: float = Field(default=0.0, ge=-180, le=180)
    """Angle of the optical axis to the left of straight ahead."""
    roll_deg: float = Field(default=0.0, ge=-180, le=180)
    """Rotation about the optical axis, clockwise as seen from behind the camera."""
    focal_length_mm: float = Field(ge=1, le=500)
    sensor_width_mm: float = Field(ge=1, le=100)
    principal_point_right_mm: float = Field(default=0.0, ge=-10, le=10)
    """Offset of the optical axis from the middle of the sensor, to the right in the image."""
    principal_point_down_mm: float = Field(default=0.0, ge=-10, le=10)
    distortion: LensDistortion = LensDistortion()
    read_out_s: float = Field(default=0.0, ge=0, le=0.1)
    """Rolling shutter: delay of the exposure of the image's bottom after its top; 0 is a global shutter."""
    sees_robot: bool = Field(default=False, exclude_if=lambda sees: not sees)
    """Whether images show the robot's body, without the camera; they always show its shadow."""


class FollowGains(Section):
    """v = K1 - K3 |e|, w = K2 e (paper Eq. 6-7), with e in units of the line sensor's weights."""

    k1_m_s: float = Field(gt=0, le=2)
    k2_rad_s: float = Field(ge=0, le=20)
    k3_m_s: float = Field(ge=0, le=2)


class WallFollowing(Section):
    gains: FollowGains
    target_distance_m: float = Field(gt=0, le=1)
    """Perpendicular distance of the sensor from the wall (paper Eq. 14)."""
    error_scale_per_m: float = Field(gt=0, le=1000)
    """Factor from the wall error to the range of the line error."""
    far_error_limit: float = Field(gt=0, le=3.5)
    """Limit of the error of a robot too far from the wall; small, so that mixed ranges at a wall's end do not turn the
    robot around that end."""
    lost_beyond_m: float = Field(gt=0, le=2)
    """Reading of the side sensor above which the followed wall is lost."""
    found_within_m: float = Field(gt=0, le=2)
    """Reading of the side sensor below which a wall can be followed."""


class Corner(Section):
    front_below_m: float = Field(gt=0, le=2)
    turn_rate_rad_s: float = Field(gt=0, le=20)
    front_clear_m: float = Field(gt=0, le=2)


class CurvePath(Section):
    """A spline in the frame of the robot where avoidance began, x forward, y left, for a bend to the left."""

    points: Annotated[tuple[Point2, ...], FromList, Field(min_length=4, max_length=100)]
    """Control points; the first is the robot itself."""


class FaceObstacle(Section):
    """Turn of the robot towards an obstacle on a bend, after which a stored path fits every encounter."""

    speed_m_s: float = Field(gt=0, le=2)
    turn_rate_rad_s: float = Field(gt=0, le=20)
    back_below_m: float = Field(ge=0, le=2)
    """Reading of the sensor that detected the obstacle below which the robot first backs off, for room to turn."""
    back_m: float = Field(ge=0, le=0.5)
    seen_below_m: float = Field(gt=0, le=2)
    """Reading of the front sensor below which it sees the obstacle."""
    max_out_rad: float = Field(gt=0, le=3.2)
    """Largest turn away from the inside of the bend in the search for the obstacle's outer edge."""
    max_in_rad: float = Field(gt=0, le=3.2)
    """Largest turn towards the inside of the bend."""
    edge_m: float = Field(gt=0, le=1)
    """Readings within this distance of the smallest belong to the middle of the obstacle."""
    face_gain_1_s: float = Field(gt=0, le=20)
    """Yaw rate per angle between the heading and the obstacle's middle."""
    tolerance_rad: float = Field(gt=0, le=1)
    tolerance_m: float = Field(gt=0, le=0.1)
    max_trim_m: float = Field(gt=0, le=0.5)
    """Longest drive that brings the obstacle to the distance at which the paths begin."""


class CurveAvoidance(Section):
    """Paths for obstacles on a bend (paper section 4.3, Fig. 7b and 7c), mirrored for a bend to the right.

    They begin where the obstacle stands straight ahead at `avoidance.front_below_m`.
    """

    side_below_m: float = Field(gt=0, le=2)
    """Reading of a side sensor below which it sees an obstacle on a bend that the front sensor cannot see."""
    ahead_below_m: float = Field(gt=0, le=2)
    """Front reading below which, on a straight, a body ahead is an obstacle; the reading is too large while the body is
    only partly in the beam."""
    both_below_m: float = Field(ge=0, le=2)
    """Reading of the front and of a side sensor below which, on a straight, an obstacle is between the two beams."""
    memory_m: float = Field(gt=0, le=10)
    """Length of the recent path over which the turn is measured."""
    straight_below_rad: float = Field(gt=0, le=3.2)
    """Turn below which the recent path is straight."""
    face: FaceObstacle
    inner: CurvePath
    outer: CurvePath
    turn_rate_rad_s: float = Field(gt=0, le=20)
    """Yaw rate of turns on the spot and largest yaw rate on the path; sharper bends are driven more slowly."""
    turn_above_rad: float = Field(gt=0, le=3.2)
    """Angle between heading and path above which the robot turns on the spot."""
    line_after_m: float = Field(gt=0, le=2)
    """Distance without the line after which the robot follows it again when it sees it."""
    cross_m: float = Field(gt=0, le=0.5)
    """Distance that the robot drives on after it meets the line, before it turns into it."""


class Avoidance(Section):
    """A pre-computed path beside the obstacle: out, along, back (paper section 4.3, Fig. 7a)."""

    front_below_m: float = Field(gt=0, le=2)
    free_side_beyond_m: float = Field(gt=0, le=2)
    out_length_m: float = Field(gt=0, le=2)
    along_length_m: float = Field(gt=0, le=2)
    back_length_m: float = Field(gt=0, le=2)
    side_m: float = Field(gt=0, le=1)
    points: int = Field(ge=10, le=100_000)
    speed_m_s: float = Field(gt=0, le=2)
    look_ahead_m: float = Field(gt=0, le=0.5)
    behind_beyond_m: float = Field(gt=0, le=2)
    """Reading of the side sensor towards the obstacle above which the obstacle is passed."""
    curves: CurveAvoidance | None = None
    """Settings of the curve paths, by which obstacles on a line are passed; without them the robot takes the straight
    path."""


class Lost(Section):
    """States 33 and 44: the robot searches for a lost wall on its side. At first it drives nearly straight, because the
    wall may continue beyond a gap.
    """

    speed_m_s: float = Field(ge=0, le=2)
    turn_rate_rad_s: float = Field(ge=0, le=20)
    gap_m: float = Field(ge=0, le=5)
    """Distance after which the robot regards the wall as ended; after a turn at once it would hit the wall's end."""
    gap_turn_rate_rad_s: float = Field(ge=0, le=20)


class Controller(Section):
    line: FollowGains
    wall: WallFollowing
    corner: Corner
    avoidance: Avoidance
    lost: Lost


class RobotConfig(Section):
    name: Slug
    description: str = ""
    chassis: Chassis
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

    def with_effect(self, effect: Effect) -> "RobotConfig":
        """Return this robot with one more effect, for example `SupplySag(source_resistance_ohm=0.4)`."""
        return self.model_copy(update={"effects": self.effects.with_effect(effect)})
