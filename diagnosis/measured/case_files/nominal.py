"""Schema of nominal.yaml: the parameters of a textbook simulator with tolerances, and the known noise."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationError

from configs.references import SECTIONS, resolve_section
from configs.schema.arena import ArenaConfig
from configs.schema.base import FromList, Section
from configs.schema.robot import RobotConfig
from configs.validation.schema_faults import all_explained
from configs.validation.shapes import Shape, with_defaults
from configs.validation.values import distributions_of
from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest, together
from symolo.core.yaml.reader import read_yaml
from symolo.core.yaml.tree import Node, dotted

Positive = Annotated[float, Field(gt=0, le=1e6)]
NotNegative = Annotated[float, Field(ge=0, le=1e6)]
Coefficients = Annotated[tuple[float, float, float, float], FromList]


class PositiveSpread(Section):
    """A positive parameter, normally distributed between units."""

    value: Positive
    tolerance: NotNegative
    """Standard deviation between units."""


class Spread(Section):
    """A parameter that may be zero or negative, normally distributed between units."""

    value: float = Field(ge=-1e6, le=1e6)
    tolerance: NotNegative


class NominalMotor(Section):
    """Parameters of a motor at the wheel shaft, as in `configs.schema.robot.Motor`."""

    winding_resistance_ohm: PositiveSpread
    torque_constant_N_m_A: PositiveSpread
    viscous_friction_N_m_s_rad: Spread
    coulomb_friction_N_m: Spread
    supply_voltage_V: Positive


class NominalMovingMotor(NominalMotor):
    """A motor whose speed changes, so that the inertia matters."""

    rotor_inertia_kg_m2: PositiveSpread
    """Moment of inertia that the motor accelerates, at the wheel shaft."""


class NominalGearedMotor(NominalMovingMotor):
    """A motor with a gearbox that may have play, which divides inertia and friction into those of two sides."""

    motor_side_inertia_fraction: float = Field(ge=0.01, le=0.99)
    """Share of the inertia that is on the motor's side of the play."""
    motor_side_friction_fraction: float = Field(ge=0, le=1)
    """Share of the friction that is on the motor's side of the play."""


class NominalRobot(Section):
    """Geometry of the wheels and resolution of their encoders."""

    wheel_radius_m: PositiveSpread
    wheel_separation_m: PositiveSpread
    encoder_ticks_per_revolution: Positive


class BenchTof(Section):
    """A range sensor before one target at a time."""

    range_offset_m: Spread
    range_scale: PositiveSpread
    reference_temperature_C: float = Field(ge=-273.15, le=200)
    """Temperature at which the readings have no error by temperature."""
    resolution_m: NotNegative
    """Step to which readings are rounded; 0 if they are not."""
    reflectance: dict[str, Annotated[float, Field(gt=0, le=1)]] = Field(min_length=1)
    """Reflectance of each material."""


class Mount(Section):
    """Place of a range sensor in the frame of the axle."""

    x_m: float
    y_m: float
    yaw_rad: float
    """Direction of the sensor, counter-clockwise from straight ahead."""


class Mounts(Section):
    """Range sensors of the robot; one that is left out is not on it, and its readings are not compared."""

    front: Mount | None = None
    left: Mount | None = None
    right: Mount | None = None


class DriveTof(Section):
    """Range sensors on a robot that drives in a room."""

    range_offset_m: Spread
    max_range_m: Positive
    """Distance beyond which the sensors see no target."""
    mount: Mounts


class KnownRoom(Section):
    """Empty room with 0 <= x <= room_x_m and 0 <= y <= room_y_m."""

    room_x_m: Positive
    room_y_m: Positive


class MotorNoise(Section):
    """Standard deviations of good readings."""

    current_A: Positive
    omega_rad_s: Positive


class StepNoise(MotorNoise):
    """Noise of motor readings at a constant rate."""

    lag1_correlation: float = Field(gt=-1, lt=1)
    """Correlation of the noise of successive readings."""


class RangeNoise(Section):
    """Standard deviation of range readings as a cubic polynomial of the distance."""

    polynomial_mm: Coefficients
    """Coefficients of p0 + p1 x + p2 x^2 + p3 x^3 with x = max(0, distance - origin) in metres."""
    polynomial_origin_m: NotNegative
    """Distance up to which the standard deviation is constant."""

    def sd_m(self, distance_m: Array) -> Array:
        """Return the standard deviation of a reading [m] at these distances, of the same shape."""
        beyond = np.maximum(distance_m - self.polynomial_origin_m, 0.0)
        return 1e-3 * np.polynomial.polynomial.polyval(beyond, np.array(self.polynomial_mm))

    def check(self, distance_m: Array, *, field: str, where: str) -> None:
        """Refuse a polynomial that is not above zero at these distances, of any shape.

        Args:
            distance_m: Distances of the readings; NaN are left out.
            field: Path of the polynomial in nominal.yaml.
            where: Path of that file.

        Raises:
            InputError: It is not above zero; the message names the shortest such distance.
        """
        known_m = np.unique(distance_m[np.isfinite(distance_m)])
        sd_m = self.sd_m(known_m)
        wrong = np.flatnonzero(~(sd_m > 0.0)).tolist()
        if wrong:
            what = f"{field}: a standard deviation of {1e3 * sd_m[wrong[0]]:.3g} mm at {known_m[wrong[0]]:.3g} m"
            raise InputError(what, where=where, allowed="above 0", cure="correct its coefficients, p0 to p3 in mm")


class DriveNoise(Section):
    """Standard deviations of the readings of a drive, and of the slip of its wheels."""

    wheel_speed_rad_s: Positive
    """Noise of a mean speed over a row, with the rounding to ticks; correlated over about 0.1 s."""
    pose_xy_m: Positive
    pose_theta_rad: Positive
    travel_m_per_sqrt_m: NotNegative
    """Slip: noise of the distance that a wheel travels in a row, over the square root of that distance."""
    tof_polynomial_mm: Coefficients
    """Coefficients of the noise of ranges, as in `RangeNoise`."""
    tof_polynomial_origin_m: NotNegative

    @property
    def tof(self) -> RangeNoise:
        return RangeNoise(polynomial_mm=self.tof_polynomial_mm, polynomial_origin_m=self.tof_polynomial_origin_m)


class NominalSteady(Section):
    """Content of nominal.yaml for a motor bench with steady speeds."""

    kind: Literal["motor_steady"]
    motor: NominalMotor
    noise: MotorNoise


class NominalStep(Section):
    """Content of nominal.yaml for a motor bench with steps of voltage."""

    kind: Literal["motor_step"]
    motor: NominalGearedMotor
    sample_rate_Hz: Positive
    noise: StepNoise


class NominalTof(Section):
    """Content of nominal.yaml for a range bench."""

    kind: Literal["tof_bench"]
    tof: BenchTof
    noise: RangeNoise


class NominalDrive(Section):
    """Content of nominal.yaml for the log of a drive."""

    kind: Literal["drive_log"]
    motor: NominalMovingMotor | None = None
    """Motors; without them, speeds are not predicted from voltages."""
    robot: NominalRobot
    tof: DriveTof | None = None
    """Range sensors; without them or the room, ranges are not predicted."""
    world: KnownRoom | None = None
    noise: DriveNoise


class LogNoise(Section):
    """Standard deviations of good readings in a data.csv."""

    d_m: Positive
    """Noise of a range up to 0.18 m; beyond it the growth of Eq. 23 is added, times `robot.tof.noise_scale`."""
    line: Positive
    """Noise of a line channel; 1 is full scale."""
    pose_xy_m: NotNegative
    pose_theta_rad: NotNegative
    v_m_s: NotNegative
    w_rad_s: NotNegative


class NominalLog(Section):
    """Content of nominal.yaml for runs with the columns of data.csv; robot and arena are those of a scenario."""

    kind: Literal["symolo_csv"]
    arena: ArenaConfig
    robot: RobotConfig
    noise: LogNoise
    holdout: Annotated[tuple[str, ...], FromList] = ()
    """Names of the runs that are held out, as patterns."""
    holdout_from_ms: float | None = Field(default=None, gt=0, le=1e10)
    """Time in a single run from which its rows are held out."""
    twist: Literal["odometry", "truth"] = "odometry"
    """Whether v and w are what the encoders of the wheels say, with the nominal wheels, or the speeds of the body."""


class KnownMotor(Section):
    """Motor of a source that states no noise, so that the data have no nominal.yaml."""

    motor: NominalMotor


class KnownWheels(Section):
    """Wheels of a robot of a source that states nothing about motors, range sensors and noise."""

    robot: NominalRobot
    wheel_radius_asymmetry: Spread
    """Left radius minus right radius, over their mean."""


NominalCase = NominalSteady | NominalStep | NominalTof | NominalDrive | NominalLog
"""Content of a nominal.yaml."""
Nominal = NominalCase | KnownMotor | KnownWheels

NOMINAL = "nominal.yaml"
MODELS: dict[str, type[NominalCase]] = {
    "motor_steady": NominalSteady,
    "motor_step": NominalStep,
    "tof_bench": NominalTof,
    "drive_log": NominalDrive,
    "symolo_csv": NominalLog,
}


def kind_of(path: Path) -> object:
    """Return the value of `kind` without checking the rest of the file; None if the file has no such key.

    Raises:
        InputError: The file is not strict YAML.
    """
    kind = read_yaml(path).root.child("kind")
    return kind.plain() if kind else None


def read_nominal(path: Path) -> NominalCase:
    """Return the parameters of one case.

    Raises:
        InputError: The file is not strict YAML or breaks the format; the message names file, line and field of every
            fault.
    """
    root = read_yaml(path).root
    kind = root.child("kind")
    name = kind.plain() if kind else None
    if not isinstance(name, str) or name not in MODELS:
        allowed = f"one of {', '.join(MODELS)}"
        where = kind.where if kind else root.where
        raise InputError("kind", where=where, got=name, allowed=allowed, nearest=nearest(name, MODELS))
    model = MODELS[name]
    if model is NominalLog:
        root = _with_sections(root, path.parent)
    try:
        return model.model_validate(root.plain())
    except ValidationError as error:
        raise together(all_explained(error, root, Shape.from_model(model))) from None


def _with_sections(root: Node, folder: Path) -> Node:
    """Return a tree with names and `extends:` of arena and robot resolved, and with defaults.

    Raises:
        InputError: There is no such arena or robot, or a value of theirs is drawn.
    """
    keys = {str(key): node for key, node in root.children()}
    for name in SECTIONS:
        if name in keys and name in NominalLog.model_fields:
            keys[name] = resolve_section(name, keys[name], folder)[0]
    root = with_defaults(Node(keys, root.where), Shape.from_model(NominalLog))
    drawn = list(distributions_of(root, NominalLog)) + [
        ("arena", "generate") for arena in (root.child("arena"),) if arena is not None and arena.child("generate")
    ]
    if drawn:
        node = root.at(drawn[0]) or root
        cure = "write the numbers of the robot and the arena that were measured"
        raise InputError(f"{dotted(drawn[0])}: is drawn for each run", where=node.where, cure=cure)
    return root
