"""Sizes of a motor, by which the start values of effects are scaled.

The start of a parameter is a visible size in the motor of the paper. In a motor that is ten times as strong, an extra
friction of that size changes nothing, and in one that is ten times as weak it stops the wheel. So the search for an
effect begins at the same share of friction, voltage, current or resistance in every motor.
"""

from dataclasses import dataclass

from configs.effects.parameter import Parameter
from configs.schema.robot import RobotConfig

LIMITS = (1e-4, 1e4)
"""Smallest and largest factor."""


@dataclass(frozen=True)
class MotorScales:
    """Sizes of a motor relative to that of the paper; 1 for that motor."""

    resistance: float = 1.0
    torque: float = 1.0
    """Dry friction."""
    voltage: float = 1.0
    """Voltage of the supply."""
    stall_current: float = 1.0
    idle_current: float = 1.0
    """Current that overcomes the dry friction."""
    speed: float = 1.0
    """Speed without load."""

    def factor(self, parameter: Parameter) -> float:
        """Return the factor on the start of a parameter, by its unit."""
        is_ceiling = parameter.null is not None and parameter.null == parameter.high
        factors = {
            "ohm": self.resistance,
            "H": self.resistance,
            "N m": self.torque,
            "N m s2/rad2": self.torque / self.speed**2,
            "V": self.voltage,
            "A": self.stall_current if is_ceiling else self.idle_current,
            "rad/s": self.speed,
        }
        return factors.get(parameter.unit, 1.0)


UNSCALED = MotorScales()
OF_PAPER = MotorScales(
    resistance=2.85, torque=0.0174, voltage=7.4, stall_current=7.4 / 2.85, idle_current=0.0174 / 0.31, speed=7.4 / 0.31
)
"""The motor of the paper's Tables 1 and 2 at two Li-ion cells, in ohm, N m, V, A, A and rad/s."""


def motor_scales(robot: RobotConfig) -> MotorScales:
    """Return the sizes of a robot's motor relative to that of the paper."""
    motor, supply_V = robot.motor, robot.power.battery_voltage_V
    resistance, constant = motor.winding_resistance_ohm, motor.torque_constant_N_m_A

    def ratio(value: float, paper_value: float) -> float:
        return min(max(value / paper_value, LIMITS[0]), LIMITS[1])

    return MotorScales(
        resistance=ratio(resistance, OF_PAPER.resistance),
        torque=ratio(motor.coulomb_friction_N_m, OF_PAPER.torque),
        voltage=ratio(supply_V, OF_PAPER.voltage),
        stall_current=ratio(supply_V / resistance, OF_PAPER.stall_current),
        idle_current=ratio(motor.coulomb_friction_N_m / constant, OF_PAPER.idle_current),
        speed=ratio(supply_V / constant, OF_PAPER.speed),
    )
