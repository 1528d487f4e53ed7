"""A file with an effect of one's own to begin with, for those slots in which there is more than one law."""

import inspect
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from symolo.core.errors import InputError, nearest


@dataclass(frozen=True)
class Law:
    """An example of a law in one slot, in the words of Python."""

    about: str
    cause: str
    excitation: str
    setups: str
    number: str
    """Declaration of its number."""
    meaning: str
    arguments: str
    result: str
    imports: tuple[str, ...] = ()


DRIVE, BENCH, RANGES, LINE = "Setup.DRIVE", "Setup.MOTOR_BENCH", "Setup.RANGE_BENCH", "Setup.LINE_LOG"
MOTION = "from physics.drivetrain.motion import ShaftMotion"
VIEW = "from sensors.ranging.range_view import RangeView"
LAWS: Mapping[Slot, Law] = MappingProxyType(
    {
        Slot.ACTUATOR: Law(
            "A bridge whose voltage changes at a limited rate.",
            "a ramp in the firmware of the driver",
            "steps and reversals of the command",
            f"{BENCH}, {DRIVE}",
            'rate_V_s: Annotated[float, Parameter("V/s", null=90_000.0, start=60.0, low=1.0, high=90_000.0)]',
            "Fastest change of the voltage.",
            "present_V: Array, command_V: Array, duration_s: float",
            "np.clip(command_V, present_V - self.rate_V_s * duration_s, present_V + self.rate_V_s * duration_s)",
        ),
        Slot.BATTERY: Law(
            "A supply that is weak just after it was switched on.",
            "a regulator that starts slowly",
            "motion in the first second",
            DRIVE,
            'share: Annotated[float, Parameter("1", null=0.0, start=0.2, low=0.0, high=0.9)]',
            "Missing share of the voltage at the start, which decays within 0.3 s.",
            "voltage_V: Array, time_s: float | Array",
            "voltage_V * (1.0 - self.share * np.exp(-np.maximum(time_s, 0.0) / 0.3))",
        ),
        Slot.BRIDGE: Law(
            "A bridge that loses a share of its voltage.",
            "a dead time between the two transistors of a branch",
            "voltages of both signs",
            f"{BENCH}, {DRIVE}",
            'share: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=0.5)]',
            "Lost share of the voltage that drives the current.",
            "emf_V: Array",
            "emf_V * (1.0 - self.share)",
        ),
        Slot.RESISTANCE: Law(
            "A contact whose resistance grows.",
            "a plug that gets loose or dirty",
            "the same voltages early and late",
            f"{BENCH}, {DRIVE}",
            'rise_per_s: Annotated[float, Parameter("1/s", null=0.0, start=1e-4, low=0.0, high=0.01)]',
            "Growth of the resistance, as a share of it.",
            "resistance_ohm: Array, time_s: float | Array",
            "resistance_ohm * (1.0 + self.rise_per_s * time_s)",
        ),
        Slot.TORQUE_CONSTANT: Law(
            "A magnet that gets weaker.",
            "a magnet that gets warm",
            "the same voltages early and late",
            f"{BENCH}, {DRIVE}",
            'loss_per_s: Annotated[float, Parameter("1/s", null=0.0, start=1e-4, low=0.0, high=0.01)]',
            "K / (1 + loss * t).",
            "torque_constant_N_m_A: Array, time_s: float | Array",
            "torque_constant_N_m_A / (1.0 + self.loss_per_s * time_s)",
        ),
        Slot.WINDING_HEAT: Law(
            "A winding that gets warm, and cools within a minute.",
            "copper has a resistance that grows with its temperature",
            "high voltages before low ones",
            f"{BENCH}, {DRIVE}",
            'rise_per_V2: Annotated[float, Parameter("1/V2", null=0.0, start=0.005, low=0.0, high=1.0)]',
            "Growth of the resistance, as a share of it, after a long time at 1 V; it is in proportion to the square.",
            "share: float | Array, voltage_V: Array, duration_s: float | Array",
            "share + (self.rise_per_V2 * voltage_V**2 - share) * -np.expm1(-duration_s / 60.0)",
        ),
        Slot.CURRENT_LIMIT: Law(
            "A driver whose current saturates softly.",
            "transistors that get warm",
            "hard starts and reversals",
            f"{BENCH}, {DRIVE}",
            'bend_per_A: Annotated[float, Parameter("1/A", null=0.0, start=0.2, low=0.0, high=5.0)]',
            "I / (1 + bend |I|).",
            "current_A: Array",
            "current_A / (1.0 + self.bend_per_A * np.abs(current_A))",
        ),
        Slot.FRICTION: Law(
            "Friction that is larger at low speed, and falls with its square.",
            "grease that is squeezed out of the gap at rest",
            "steady speeds from slow to fast",
            f"{BENCH}, {DRIVE}",
            'extra_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.005, low=0.0, high=0.5)]',
            "Extra friction at rest; at 5 rad/s half of it is left.",
            "friction_N_m: Array, motion: ShaftMotion",
            "friction_N_m + self.extra_N_m / (1.0 + (motion.speed_rad_s / 5.0) ** 2)",
            (MOTION,),
        ),
        Slot.SHAFT_TORQUE: Law(
            "A constant torque on the shaft.",
            "a weight that hangs on the shaft",
            "steps in both directions",
            BENCH,
            'load_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.01, low=-0.5, high=0.5)]',
            "Torque against forward motion.",
            "torque_N_m: Array, angle_rad: Array, turned_rad: Array",
            "torque_N_m - self.load_N_m",
        ),
        Slot.ROLLING: Law(
            "Wheels that are oval.",
            "a tyre that was stored under load",
            "several turns of the wheels, with poses more often than twice a turn",
            DRIVE,
            'amplitude: Annotated[float, Parameter("1", null=0.0, start=0.05, low=-0.3, high=0.3)]',
            "Change of the radius as a share, twice per turn.",
            "share: Array, angle_rad: Array, turned_rad: Array",
            "share + self.amplitude * np.cos(2.0 * angle_rad)",
        ),
        Slot.GROUND: Law(
            "Turns that are too small by a share that grows with the yaw rate.",
            "tyres that are twisted against the floor",
            "turns on the spot at several yaw rates",
            DRIVE,
            'coefficient_s_rad: Annotated[float, Parameter("s/rad", null=0.0, start=0.1, low=0.0, high=2.0)]',
            "dtheta = dtheta_kinematic / (1 + coefficient |yaw rate|).",
            "share: Array, speed_m_s: Array, yaw_rate_rad_s: Array",
            "share / (1.0 + self.coefficient_s_rad * np.abs(yaw_rate_rad_s))",
        ),
        Slot.COUNTING: Law(
            "Encoders that lose a share of their counts.",
            "a weak pull-up resistor",
            "any drive with known poses",
            DRIVE,
            'share: Annotated[float, Parameter("1", null=0.0, start=0.05, low=0.0, high=0.5)]',
            "Lost share, at both wheels.",
            "turned_rad: Array, duration_s: float",
            "turned_rad * (1.0 - self.share)",
        ),
        Slot.CURRENT_READING: Law(
            "A current sensor whose gain falls with the current.",
            "a magnetic core that saturates",
            "small and large currents",
            f"{BENCH}, {DRIVE}",
            'bend_per_A: Annotated[float, Parameter("1/A", null=0.0, start=0.1, low=0.0, high=2.0)]',
            "reading = I / (1 + bend |I|).",
            "current_A: Array",
            "current_A / (1.0 + self.bend_per_A * np.abs(current_A))",
        ),
        Slot.CURRENT_GAIN: Law(
            "A current sensor whose gain drifts.",
            "an amplifier that gets warm",
            "the same voltages early and late",
            f"{BENCH}, {DRIVE}",
            'drift_per_s: Annotated[float, Parameter("1/s", null=0.0, start=1e-4, low=-1e-4, high=0.01)]',
            "Growth of the gain, as a share of it.",
            "gain: Array, time_s: Array",
            "gain * (1.0 + self.drift_per_s * time_s)",
        ),
        Slot.SPEED_GAIN: Law(
            "A tachometer whose gain drifts.",
            "a magnet of the generator that gets warm",
            "the same voltages early and late",
            f"{BENCH}, {DRIVE}",
            'drift_per_s: Annotated[float, Parameter("1/s", null=0.0, start=1e-4, low=-1e-4, high=0.01)]',
            "Growth of the gain, as a share of it.",
            "gain: Array, time_s: Array",
            "gain * (1.0 + self.drift_per_s * time_s)",
        ),
        Slot.SPEED_READING: Law(
            "A tachometer whose gain falls with the speed.",
            "an amplifier that saturates",
            "slow and fast speeds",
            BENCH,
            'bend_s_rad: Annotated[float, Parameter("s/rad", null=0.0, start=0.01, low=0.0, high=1.0)]',
            "reading = w / (1 + bend |w|).",
            "speed_rad_s: Array",
            "speed_rad_s / (1.0 + self.bend_s_rad * np.abs(speed_rad_s))",
        ),
        Slot.POSE_POINT: Law(
            "A tracking system with a wrong scale.",
            "a calibration with a plate of another size",
            "drives over the whole floor",
            DRIVE,
            'scale: Annotated[float, Parameter("1", null=1.0, start=1.02, low=0.5, high=2.0)]',
            "Logged over true position; the heading is right.",
            "pose: Array",
            "pose + (self.scale - 1.0) * pose * np.array([1.0, 1.0, 0.0])",
        ),
        Slot.POSE_DELAY: Law(
            "Poses that are late after the start, until the tracking system has caught up.",
            "a queue that is full at the start",
            "motion in the first seconds, and later",
            DRIVE,
            'delay_s: Annotated[float, Parameter("s", null=0.0, start=0.1, low=0.0, high=0.5)]',
            "Delay at the start; it decays within a second.",
            "late_s: float | Array, time_s: float | Array",
            "late_s + self.delay_s * np.exp(-np.maximum(time_s, 0.0))",
        ),
        Slot.RANGE_MOUNT: Law(
            "Range sensors that are all turned by one angle.",
            "a holder that is mounted askew",
            "walls at an angle",
            DRIVE,
            'angle_rad: Annotated[float, Parameter("rad", null=0.0, start=0.05, low=-0.5, high=0.5)]',
            "Turn of all three sensors, counter-clockwise.",
            "yaw_rad: Array",
            "yaw_rad + self.angle_rad",
        ),
        Slot.RAY_WEIGHT: Law(
            "Light that the air absorbs.",
            "dust or smoke",
            "targets with near and far parts in one view",
            "Setup.RANGE_SCAN",
            'loss_per_m: Annotated[float, Parameter("1/m", null=0.0, start=2.0, low=0.0, high=20.0)]',
            "weight * exp(-loss * distance).",
            "weight: Array, distance_m: Array",
            "weight * np.exp(-self.loss_per_m * distance_m)",
        ),
        Slot.RANGE: Law(
            "Ranges that are alternately too long and too short.",
            "light that is reflected inside the cover",
            "ranges over some decimetres",
            f"{DRIVE}, {RANGES}",
            'amplitude_m: Annotated[float, Parameter("m", null=0.0, start=0.01, low=-0.1, high=0.1)]',
            "reading + amplitude * sin(2 pi distance / 0.2 m).",
            "reading_m: Array, view: RangeView",
            "reading_m + self.amplitude_m * np.sin(2.0 * np.pi * view.distance_m / 0.2)",
            (VIEW,),
        ),
        Slot.RANGE_NOISE: Law(
            "Noise that grows with the angle of the target.",
            "echoes that are wider before an oblique target",
            "many readings of targets at several angles",
            RANGES,
            'coefficient_per_rad2: Annotated[float, Parameter("1/rad2", null=0.0, start=2.0, low=0.0, high=50.0)]',
            "sd * (1 + coefficient * angle^2).",
            "sd_m: Array, view: RangeView",
            "sd_m * (1.0 + self.coefficient_per_rad2 * view.incidence_rad**2)",
            (VIEW,),
        ),
        Slot.RANGE_LIMIT: Law(
            "A sensor that never reads less than some distance.",
            "a dead zone in front of the sensor",
            "targets that are very near",
            f"{DRIVE}, {RANGES}",
            'nearest_m: Annotated[float, Parameter("m", null=0.0, start=0.1, low=0.0, high=1.0)]',
            "Smallest reading.",
            "reading_m: Array",
            "np.maximum(reading_m, self.nearest_m)",
        ),
        Slot.LINE_PLACE: Law(
            "A line sensor whose channels are further apart.",
            "a board of another version",
            "the line under all channels",
            LINE,
            'scale: Annotated[float, Parameter("1", null=1.0, start=1.1, low=0.5, high=2.0)]',
            "True over specified distance of the channels.",
            "place_m: Array",
            "place_m * self.scale",
        ),
        Slot.LINE_READING: Law(
            "A line sensor whose scale is bent.",
            "a phototransistor that is not linear",
            "bright and dark floor, and the edges of the line",
            LINE,
            'bend: Annotated[float, Parameter("1", null=0.0, start=0.2, low=-0.9, high=0.9)]',
            "reading + bend * reading * (1 - reading).",
            "reading: Array",
            "reading + self.bend * reading * (1.0 - reading)",
        ),
    }
)
"""One example in each slot for which a file is written. In the other slots, a number or three describe all there is,
and shipped effects have them, or a law needs more than a line."""

TEXT = '''"""{about}"""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
{imports}from symolo.core.arrays import Array

# The name of the class in lower case is the name of the effect: robot.effects.{name}
# `symolo effect check` tests the file and explains each rule.


class {class_name}(Effect):
    slot = Slot.{slot}  # where it acts: {words}
    cause = "{cause}"
    excitation = "{excitation}"
    # Measurements in which the diagnosis looks for it.
    setups = ({setups})

    # Unit, value without effect, visible value at which a fit starts, and bounds. The name ends in the unit.
    # A further number of shape, such as a decay length, has null=None.
    {number}
    """{meaning}"""

    def apply(self, {arguments}) -> Array:
        # A pure function: no random numbers, no memory, no change of the arguments. Everything may be an array, also
        # self.{parameter}, since a fit computes many robots at once. Take np.where in the place of if.
        return {result}
'''


def template(name: str, slot: Slot) -> str:
    """Return the text of a file with one effect that keeps the contract.

    Args:
        name: Name of the effect in lower case with underscores.
        slot: One of `LAWS`.

    Raises:
        InputError: The name cannot be that of an effect, or a shipped effect has it.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*", name) or len(name) > 60:
        allowed = "small letters and digits, words joined by '_', such as oval_wheel"
        raise InputError("NAME", got=name, allowed=allowed)
    if name in {effect.name for effect in EFFECTS.shipped}:
        raise InputError("NAME", got=name, cure="a shipped effect has this name; take another one")
    law = LAWS[slot]
    imports = "".join(f"{line}\n" for line in law.imports)
    text = TEXT.format(
        about=law.about,
        imports=imports,
        name=name,
        class_name="".join(word.capitalize() for word in name.split("_")),
        slot=slot.name,
        words=slot,
        cause=law.cause,
        excitation=law.excitation,
        setups=law.setups if "," in law.setups else f"{law.setups},",
        number=law.number,
        meaning=law.meaning,
        arguments=law.arguments,
        parameter=law.number.partition(":")[0],
        result=law.result,
    )
    text = text.replace("import numpy as np\n\n", "") if "np." not in law.result else text
    return text if "Array" in law.arguments else text.replace("from symolo.core.arrays import Array\n", "")


def slot_named(text: str) -> Slot:
    """Return the slot with a name, whose words may be joined by '-' or '_'.

    Raises:
        InputError: There is none, or no file can be written for it.
    """
    known = {slot.value: slot for slot in Slot}
    name = text.lower().replace("-", " ").replace("_", " ")
    allowed = ", ".join(sorted(LAWS))
    if name not in known:
        raise InputError("--slot", got=text, allowed=allowed, nearest=nearest(name, LAWS))
    slot = known[name]
    if slot not in LAWS:
        shipped = next((effect for effect in EFFECTS.shipped if effect.slot is slot), None)
        cure = f"there is no template for this slot; begin with a copy of {inspect.getfile(shipped)}" if shipped else ""
        raise InputError("--slot", got=text, allowed=allowed, cure=cure)
    return slot
