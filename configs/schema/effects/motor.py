"""Effects in motor, driver, supply and gearbox. All quantities at the wheel shaft."""

from typing import Annotated

from configs.schema.base import Section
from configs.schema.effects.parameter import Asymmetry, Delay, DriftTime, LagTime, Parameter, Scale


class WindingResistanceScale(Section):
    scale: Scale
    """R_true = scale * R."""


class TorqueConstantScale(Section):
    scale: Scale
    """K_true = scale * K, in torque and back-EMF."""


class ViscousFrictionScale(Section):
    scale: Scale
    """B_true = scale * B."""


class CoulombFrictionScale(Section):
    scale: Scale
    """Tc_true = scale * Tc."""


class RotorInertiaScale(Section):
    scale: Scale
    """J_true = scale * J."""


class StribeckFriction(Section):
    extra_torque_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.008, low=0.0, high=1.0)]
    """Friction + extra_torque * exp(-(w / stribeck_speed)^2), against the motion; breakaway at Tc + extra_torque."""
    stribeck_speed_rad_s: Annotated[float, Parameter("rad/s", null=None, start=2.0, low=0.05, high=50.0)]


class QuadraticDrag(Section):
    coefficient_N_m_s2_rad2: Annotated[float, Parameter("N m s2/rad2", null=0.0, start=1e-4, low=0.0, high=0.1)]
    """Friction + coefficient * w |w|."""


class FrictionAsymmetry(Section):
    asymmetry: Asymmetry
    """Tc (1 - asymmetry) forward, Tc (1 + asymmetry) in reverse."""


class FrictionWarmup(Section):
    amplitude: Annotated[float, Parameter("1", null=0.0, start=0.3, low=-0.9, high=5.0)]
    """Tc (1 + amplitude * exp(-t / time_constant)), t since the motor was first switched on."""
    time_constant_s: DriftTime


class BridgeVoltageDrop(Section):
    drop_V: Annotated[float, Parameter("V", null=0.0, start=0.3, low=0.0, high=5.0)]
    """Lost in the bridge, against the current: I = sgn(e) max(|e| - drop, 0) / R with e = u - K w."""


class SupplySag(Section):
    source_resistance_ohm: Annotated[float, Parameter("ohm", null=0.0, start=0.5, low=0.0, high=20.0)]
    """In series with the supply, which gives |duty| |I| of each motor; u falls in proportion to the supply's voltage.
    Of one motor alone I = e / (R + source_resistance duty^2)."""


class InputDelay(Section):
    delay_s: Delay
    """The commanded voltage acts this much later."""


class ActuatorLag(Section):
    time_constant_s: LagTime
    """The voltage follows the command with a first-order lag."""


class CurrentLimit(Section):
    limit_A: Annotated[float, Parameter("A", null=1000.0, start=0.8, low=0.01, high=1000.0)]
    """|I| <= limit; the upper bound stands for none."""


class GearBacklash(Section):
    gap_rad: Annotated[float, Parameter("rad", null=0.0, start=0.05, low=0.0, high=1.0)]
    """Play between motor side and load side, at the wheel shaft; inelastic contact, start in mid-gap."""


class CurrentSensorOffset(Section):
    offset_A: Annotated[float, Parameter("A", null=0.0, start=0.03, low=-2.0, high=2.0)]
    """measured = true + offset."""


class CurrentSensorGain(Section):
    gain: Scale
    """measured = gain * true."""


class SpeedScale(Section):
    scale: Scale
    """measured speed = scale * true, by wrong counts per revolution."""


class SpeedFilterLag(Section):
    time_constant_s: LagTime
    """The measured speed is low-pass filtered, first order."""


class SpeedTimeOffset(Section):
    delay_s: Delay
    """The measured speed is logged this much late; the current is not."""
