"""Play between the motor side of a gearbox and its load side."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from configs.validation.faults import ConfigFault
from physics.drivetrain.two_mass import Load, TwoMass
from symolo.core.arrays import Array


class GearBacklash(Effect):
    """Motor and load turn independently within a gap, and push each other at its ends."""

    slot = Slot.GEARBOX
    cause = "worn gears, loose couplings"
    excitation = "reversals and braking"
    setups = (Setup.MOTOR_BENCH,)

    gap_rad: Annotated[float, Parameter("rad", null=0.0, start=0.05, low=0.0, high=1.0, tries=(0.06, 0.02))]
    """Play between motor side and load side, at the wheel shaft. Contact is inelastic; motion starts in mid-gap."""

    def apply(self, state: TwoMass, motor: Load, load: Load, duration_s: float | Array) -> TwoMass:
        """Return the state after one step: the sides move separately until they meet, and then as one mass.

        They meet at most once. The moment of contact follows from the mean relative speed over the step; contact is
        inelastic.
        """
        half = 0.5 * self.gap_rad
        motor_rad_s, motor_rad = motor.moved(state.motor_rad_s, duration_s)
        load_rad_s, load_rad = load.moved(state.load_rad_s, duration_s)
        relative_rad = motor_rad - load_rad
        slack_rad = state.slack_rad + relative_rad
        pushing = np.abs(slack_rad) >= half
        if not np.count_nonzero(pushing):
            return TwoMass(motor_rad_s, load_rad_s, slack_rad)
        nonzero_rad = np.where(relative_rad == 0.0, 1.0, relative_rad)
        apart = np.minimum(np.maximum((half * np.sign(slack_rad) - state.slack_rad) / nonzero_rad, 0.0), 1.0)
        at_contact = (
            motor.inertia_kg_m2 * (state.motor_rad_s + apart * (motor_rad_s - state.motor_rad_s))
            + load.inertia_kg_m2 * (state.load_rad_s + apart * (load_rad_s - state.load_rad_s))
        ) / (motor.inertia_kg_m2 + load.inertia_kg_m2)
        together, _ = (motor + load).moved(at_contact, (1.0 - apart) * duration_s)
        return TwoMass(
            np.where(pushing, together, motor_rad_s),
            np.where(pushing, together, load_rad_s),
            np.minimum(np.maximum(slack_rad, -half), half),
        )

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        if in_simulation and self.gap_rad > 0:
            problem = "PyBullet's wheel is one mass, without play"
            cure = "remove the effect; it acts on the motor bench alone"
            yield ConfigFault(("gap_rad",), problem, got=self.gap_rad, allowed="0", cure=cure)
