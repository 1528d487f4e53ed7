"""An effect: one deviation of a robot from its description, written as one class in one file.

The class holds all that the project knows about the effect. Its fields are config keys with units and bounds
(`robot.effects.<name>.<field>`), axes of randomisation and numbers of a hypothesis of the diagnosis; `slot` and `apply`
define the simulation; `cause` and `excitation` are texts of report and documentation.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, ClassVar, TypeVar, get_args

from typing_extensions import Self

from configs.effects.parameter import Parameter, Plausible
from configs.families import name_in_lower_case
from configs.schema.base import Section
from configs.validation.faults import ConfigFault
from symolo.core.text_enum import TextEnum

Metadata = TypeVar("Metadata")


class Slot(TextEnum):
    """The places of the signal chain, with the arguments of `apply` and its result.

    Arrays of wheels have the wheels as their last axis, right and left; a single motor on a bench has one of length 1.
    """

    MOTORS = "motors"
    """`Motors` -> `Motors`."""
    COMMAND_DELAY = "command delay"
    """delay [s] -> delay [s]."""
    ACTUATOR = "actuator"
    """present voltage [V], commanded voltage [V], duration [s] -> voltage [V] after the duration."""
    BATTERY = "battery"
    """voltage [V], time since the start [s] -> voltage [V]."""
    CONDUCTION = "conduction"
    """voltage that drives the current of a winding that is always connected, u - K w [V], `Chopper` -> the same."""
    BRIDGE = "bridge"
    """voltage that drives the current, u - K w [V] -> the same."""
    SUPPLY = "supply"
    """u - K w [V] before the loss of the bridge, `Bridge` -> current [A]."""
    RESISTANCE = "resistance"
    """winding resistance [ohm], time since the motor was first switched on [s] -> resistance."""
    TORQUE_CONSTANT = "torque constant"
    """torque constant, which is also the back-EMF constant [N m/A], time since the motor was first switched on [s] ->
    constant."""
    WINDING_HEAT = "winding heat"
    """share by which heat has raised the winding resistance, mean voltage at the motor [V], duration [s] -> share after
    the duration. It is 0 before the motor is first switched on, and at the start of a trial."""
    CURRENT_LIMIT = "current limit"
    """current [A] -> current [A]."""
    FRICTION = "friction"
    """friction torque against the motion [N m], `ShaftMotion` -> the same torque."""
    SHAFT_TORQUE = "shaft torque"
    """torque on the shaft without friction [N m], angles of the shafts since the start [rad], turns [rad] that begin
    there -> mean torque over these turns."""
    GEARBOX = "gearbox"
    """`TwoMass`, `Load` of motor side and load side, duration [s] -> `TwoMass`."""
    GEOMETRY = "geometry"
    """`WheelGeometry` -> `WheelGeometry`."""
    ROLLING = "rolling"
    """travel of both wheels as a share of radius * turn (..., 2), wheel angles in the middle of the turn [rad], turns
    [rad] -> share."""
    TRAVEL = "travel"
    """travel of both wheels over the floor as a share of that by their rolling (..., 2), `FloorPlace` -> share."""
    SLIP = "slip"
    """random share of the travels of both wheels (2,), travel [m] since the wheels had it (2,), standard normal
    deviates (2,) -> share."""
    CREEP = "creep"
    """movement over the floor besides rolling, x, y [m] in W (..., 2), mean size of the wheels' travels [m] (..., 1),
    size of the mean travel [m] (..., 1) -> movement."""
    GROUND = "ground"
    """remaining share of the yaw rate, speed [m/s], yaw rate [rad/s], both computed from the wheels -> share."""
    TURNING = "turning"
    """yaw rate as a share of that by the travels of the wheels and the track (..., 1), `FloorPlace` -> share."""
    ENCODER = "encoder"
    """counts per revolution -> counts per revolution."""
    COUNTING = "counting"
    """turned angle [rad], duration [s] -> counted angle [rad]."""
    CURRENT_READING = "current reading"
    """current [A] -> current [A]."""
    SPEED_READING = "speed reading"
    """speed [rad/s] -> speed [rad/s]."""
    CURRENT_GAIN = "current gain"
    """measured over true current, time since the instrument was switched on [s] -> the same ratio."""
    SPEED_GAIN = "speed gain"
    """measured over true speed, time since the instrument was switched on [s] -> the same ratio."""
    SPEED_RIPPLE = "speed ripple"
    """measured over true speed, angle that the shaft has turned [rad] -> the same ratio. A speed that has settled is a
    mean over turns, without ripple."""
    CURRENT_ERROR = "current error"
    """error that is added to the reading of the current [A], time since the instrument was switched on [s] -> error."""
    SPEED_ERROR = "speed error"
    """error that is added to the reading of the speed [rad/s], time since the instrument was switched on [s] ->
    error."""
    SPEED_FILTER = "speed filter"
    """filtered speed [rad/s], speed before and now [rad/s], duration [s] between -> filtered speed [rad/s] now."""
    SPEED_DELAY = "speed delay"
    """delay [s] -> delay [s]."""
    POSE_POINT = "pose point"
    """pose x [m], y [m], yaw [rad] (..., 3) -> pose."""
    POSE_HEADING = "pose heading"
    """error of the logged yaw [rad], yaw of the robot in W [rad], time since the start of the session [s] -> error."""
    POSE_DELAY = "pose delay"
    """delay [s], time since the start of the drive [s] -> delay [s]."""
    RANGE_MOUNT = "range mount"
    """yaw of the three sensors [rad] (3,) -> yaw."""
    RAY_WEIGHT = "ray weight"
    """weight of each ray (..., rays), distance along it [m] -> weight. Only the ratios of the weights matter."""
    RANGE_GATHERING = "range gathering"
    """time over which light is gathered [s] -> time [s]."""
    RANGE = "range"
    """reading [m], `RangeView` -> reading [m]."""
    RANGE_WANDER = "range wander"
    """slow error [m], duration since it had this value [s], standard normal deviates -> slow error [m]."""
    RANGE_NOISE = "range noise"
    """standard deviation [m], `RangeView` -> standard deviation [m]."""
    RANGE_LIMIT = "range limit"
    """reading [m] with its noise, rounded -> reading [m]."""
    RANGE_DELAY = "range delay"
    """delay [s] -> delay [s]."""
    LINE_PLACE = "line place"
    """places of the line channels to the left [m] -> places."""
    LINE_HEIGHT = "line height"
    """height of the line sensor over the specified height -> the same."""
    LINE_READING = "line reading"
    """reflectances (..., 8) as read without noise -> the same."""
    LINE_LIMIT = "line limit"
    """readings (..., 8) with their noise -> readings."""


RANDOM_SLOTS = frozenset({Slot.RANGE_WANDER, Slot.SLIP})
"""Slots of random effects, which no prediction has."""


class Setup(TextEnum):
    """The object of a measurement: a motor alone, a range sensor before one target at a time, a range sensor that is
    moved past an object, a robot that drives, or one whose log has the channels of its line sensor.
    """

    MOTOR_BENCH = "motor bench"
    RANGE_BENCH = "range bench"
    RANGE_SCAN = "range scan"
    DRIVE = "drive"
    LINE_LOG = "log with a line sensor"


class Effect(Section):
    """Base of all effects. An instance is the effect with its values in one robot."""

    name: ClassVar[str]
    """Name of the class in lower case with underscores: `SupplySag` is `supply_sag`."""
    slot: ClassVar[Slot]
    cause: ClassVar[str]
    """Cause of the effect in a robot."""
    excitation: ClassVar[str]
    """Excitation that a measurement must contain to reveal the effect."""
    setups: ClassVar[tuple[Setup, ...]] = tuple(Setup)
    """Measurements in which the diagnosis looks for the effect; in any other one it does not consider it."""
    grows_with_time: ClassVar[bool] = False
    """Whether the effect grows in proportion to the time; errors of an integration are alike early and late."""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:  # noqa: ANN401 - as pydantic declares it
        super().__pydantic_init_subclass__(**kwargs)
        cls.name = name_in_lower_case(cls)

    def apply(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401 - each slot has its own arguments
        """Return the first argument changed by this effect. The function is pure; `Slot` lists its arguments."""
        raise NotImplementedError

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        """Yield the faults of values that are impossible or cannot be simulated; paths start at the effect's fields.

        Args:
            in_simulation: Whether PyBullet drives the robot; otherwise a bench may measure it.
        """
        del in_simulation
        yield from ()

    @classmethod
    @cache
    def parameters(cls) -> Mapping[str, Parameter]:
        """Return the numbers of the effect, which can be fitted."""
        return cls._metadata(Parameter)

    @classmethod
    @cache
    def plausible_sizes(cls) -> Mapping[str, Plausible]:
        """Return the limits of those numbers that have an impossible size."""
        return cls._metadata(Plausible)

    @classmethod
    @cache
    def options(cls) -> Mapping[str, tuple[str, ...]]:
        """Return the allowed values of each parameter that is not a number; empty where any name is allowed."""
        numbers, fields = cls.parameters(), cls.model_fields
        return MappingProxyType({n: get_args(f.annotation) for n, f in fields.items() if n not in numbers})

    @classmethod
    def null(cls, choices: Mapping[str, str] = MappingProxyType({})) -> Self:
        """Return the effect with values at which it changes nothing.

        Args:
            choices: Values of the parameters that are not numbers.
        """
        return cls.model_validate({**choices, **{n: p.without_effect for n, p in cls.parameters().items()}})

    @classmethod
    def start(cls, choices: Mapping[str, str] = MappingProxyType({})) -> Self:
        """Return the effect with plausible values, from which a fit starts.

        Args:
            choices: Values of the parameters that are not numbers.
        """
        return cls.model_validate({**choices, **{n: p.start for n, p in cls.parameters().items()}})

    def without_effect(self) -> Self:
        """Return the same effect with the same choices, changing nothing."""
        return self.model_copy(update={n: p.without_effect for n, p in self.parameters().items()})

    @classmethod
    def _metadata(cls, kind: type[Metadata]) -> Mapping[str, Metadata]:
        fields = cls.model_fields.items()
        return MappingProxyType({n: m for n, field in fields for m in field.metadata if isinstance(m, kind)})
