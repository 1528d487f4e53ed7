"""A bridge that switches all its transistors off in the off time, so that the motor coasts."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter, Plausible
from physics.drivetrain.bridge import Chopper
from symolo.core.arrays import Array

MIN_RATIO = 1e-9


class BridgeCoast(Effect):
    """The bridge disconnects the motor in the off time of its PWM, so that the current falls to zero early and the mean
    voltage at the motor is not duty times supply.
    """

    slot = Slot.CONDUCTION
    cause = "a driver in fast decay (coast) mode, with PWM on its enable pin or on one input"
    excitation = "speeds at all duty cycles, low and high"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    inductance_H: Annotated[
        float,
        Parameter("H", null=0.0, start=5e-4, low=0.0, high=0.5, tries=(0.05, 0.01, 0.002)),
        Plausible(0.0, 0.05, "the windings of small motors have 0.1 to 10 mH"),
    ]
    """Inductance of the winding; 0 stands for a bridge that brakes in its off time, where u = duty * supply is the
    mean voltage. In a bridge that coasts, the current of the off time flows back into the supply through the diodes,
    against supply + diode. If it falls to zero within a period, it stays there until the next one."""
    diode_V: Annotated[
        float,
        Parameter("V", null=0.0, start=1.0, low=0.0, high=100.0),
        Plausible(0.0, 4.0, "a diode loses 0.3 to 1.2 V, and rarely more"),
    ]
    """Voltage lost in the diodes that conduct in the off time, two in series."""
    switching_Hz: Annotated[
        float, Parameter("Hz", null=None, start=20_000.0, low=20.0, high=90_000.0, is_known=True)
    ] = 20_000.0
    """Switching frequency. Mean currents and speeds depend only on its product with the inductance, so a fit takes it
    as it is and finds the inductance that belongs to it."""

    def apply(self, emf_V: Array, chopper: Chopper) -> Array:
        """Return the winding resistance times the mean current over one period, at a constant speed [V].

        The solution of L di/dt = v - E - R i in on time and off time: Mohan, Undeland and Robbins, Power Electronics,
        3rd ed., chapter 7; Krishnan, Electric Motor Drives, chapter 4. Times are in periods; `ratio` is the time
        constant L / R. In a period that begins without current, the volt-seconds at the inductance add up to zero, so
        that the mean is that of the voltages at the winding while current flows. A period that does not begin without
        current has none of the pause, whatever the current at its beginning.
        """
        ratio = np.maximum(self.inductance_H * self.switching_Hz / chopper.resistance_ohm, MIN_RATIO)
        duty = np.minimum(np.abs(chopper.duty), 1.0)
        supply_V = chopper.supply_V(emf_V)
        on_V = np.sign(chopper.duty) * supply_V - chopper.back_emf_V
        size_V, direction = np.abs(on_V), np.sign(on_V)
        off_V = supply_V + self.diode_V + direction * chopper.back_emf_V
        peak_V = -size_V * np.expm1(-duty / ratio)
        # A motor that is driven faster than supply and diodes can stop its current rectifies for the whole off time.
        is_opposed, off_time = off_V > 0.0, 1.0 - duty
        falls = ratio * np.log1p(peak_V / np.where(is_opposed, off_V, np.inf))
        falls = np.where(is_opposed, np.minimum(falls, off_time), off_time)
        mean_V = direction * (size_V * duty - off_V * falls)
        return np.where(self.inductance_H > 0.0, mean_V, emf_V)
