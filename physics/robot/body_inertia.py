"""Load of the robot's body on its wheels: inertia, centrifugal forces, friction of the caster.

Without slip the body has two coordinates, the wheel angles. Everything is referred to them.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

import numpy as np

from physics.robot.model import RobotModel
from symolo.core.arrays import Array

GRAVITY_M_S2 = 9.81
CREEP_M_S = 1e-3
"""Speed below which the caster's friction fades; the dry friction of the wheels is what makes them stick."""


@dataclass(frozen=True)
class BodyOnWheels:
    """The robot's body as its wheels feel it, with the wheel angles as generalised coordinates."""

    to_twist: Array
    """(2, 2): forward speed [m/s] and yaw rate [rad/s] from wheel speeds, right and left [rad/s]."""
    wheel_inertia_kg_m2: Array
    """(2, 2), of body and wheels, without rotors; off the diagonal the coupling of the wheels' accelerations."""
    moment_kg_m: float
    """Mass times its distance in front of the axle."""
    caster_force_N: float
    """Coulomb friction between caster and floor."""
    caster_x_m: float
    """Position of the caster ahead of the axle."""

    @classmethod
    def from_model(cls, model: RobotModel) -> "BodyOnWheels":
        robot, geometry = model.config, model.geometry
        right, left, track = geometry.right_radius_m, geometry.left_radius_m, geometry.track_m
        to_twist = np.array([[0.5 * right, 0.5 * left], [right / track, -left / track]])
        chassis, drive = robot.chassis, robot.drive
        x = chassis.center_of_mass_x_m
        mass = chassis.mass_kg + 2.0 * drive.wheel_mass_kg
        yaw_inertia = chassis.mass_kg * ((chassis.length_m**2 + chassis.width_m**2) / 12.0 + x**2)
        radii = np.array([right, left])
        across = drive.wheel_mass_kg * (3.0 * radii**2 + drive.wheel_width_m**2) / 12.0
        yaw_inertia += float(across.sum()) + 0.5 * drive.wheel_mass_kg * track**2
        spin = np.diag(0.5 * drive.wheel_mass_kg * radii**2)
        return cls(
            to_twist=to_twist,
            wheel_inertia_kg_m2=to_twist.T @ np.diag([mass, yaw_inertia]) @ to_twist + spin,
            moment_kg_m=chassis.mass_kg * x,
            caster_force_N=drive.caster_friction * chassis.mass_kg * GRAVITY_M_S2 * x / drive.caster_x_m,
            caster_x_m=drive.caster_x_m,
        )

    @overload
    def load_N_m(self, right_rad_s: float, left_rad_s: float) -> tuple[float, float]: ...
    @overload
    def load_N_m(self, right_rad_s: Array, left_rad_s: Array) -> tuple[Array, Array]: ...
    def load_N_m(self, right_rad_s: float | Array, left_rad_s: float | Array) -> tuple[Any, Any]:
        """Return the torques on the wheels, right and left, that depend on their speeds; floats or arrays."""
        (right_m, left_m), (right_share, left_share) = self._rows
        v = right_m * right_rad_s + left_m * left_rad_s
        w = right_share * right_rad_s + left_share * left_rad_s
        across = w * self.caster_x_m
        # Coulomb friction against the velocity of the caster, (v, w x), which fades below `CREEP_M_S`.
        grip = self.caster_force_N / ((v * v + across * across) ** 0.5 + CREEP_M_S)
        # A centre of mass ahead of the axle pulls the axle forward by m x w^2 and brakes the turn by m x v w.
        force_N = self.moment_kg_m * w * w - grip * v
        torque_N_m = -self.moment_kg_m * v * w - grip * across * self.caster_x_m
        return right_m * force_N + right_share * torque_N_m, left_m * force_N + left_share * torque_N_m

    @cached_property
    def _rows(self) -> list[list[float]]:
        """Rows of `to_twist` as floats, with which Python is ten times as fast as with numpy scalars."""
        return self.to_twist.tolist()
