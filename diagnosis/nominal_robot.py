"""The robot of a textbook simulation of a measured case: a shipped robot with the case's nominal parameters in it."""

from configs.schema.robot import RobotConfig
from diagnosis.measured.nominal import NominalGearedMotor, NominalSteady, NominalStep


def nominal_robot(nominal: NominalSteady | NominalStep, carrier: RobotConfig) -> RobotConfig:
    """The robot on the motor bench: motor and supply are nominal, what the case does not speak of is `carrier`'s."""
    motor = nominal.motor
    numbers = {
        "winding_resistance_ohm": motor.winding_resistance_ohm.value,
        "torque_constant_N_m_A": motor.torque_constant_N_m_A.value,
        "viscous_friction_N_m_s_rad": motor.viscous_friction_N_m_s_rad.value,
        "coulomb_friction_N_m": motor.coulomb_friction_N_m.value,
    }
    if isinstance(motor, NominalGearedMotor):
        numbers["rotor_inertia_kg_m2"] = motor.rotor_inertia_kg_m2.value
        numbers["motor_side_inertia_fraction"] = motor.motor_side_inertia_fraction
        numbers["motor_side_friction_fraction"] = motor.motor_side_friction_fraction
    supply = {"battery_voltage_V": motor.supply_voltage_V, "motor_voltage_limit_V": motor.supply_voltage_V}
    sections = {
        "motor": carrier.motor.model_copy(update=numbers),
        "power": carrier.power.model_copy(update=supply),
    }
    return carrier.model_copy(update=sections)
