"""Effects on the robot itself: motor, driver, supply, gearbox, wheels, ground and encoders."""

EFFECTS = (
    "winding_resistance_scale",
    "torque_constant_scale",
    "torque_constant_mismatch",
    "viscous_friction_scale",
    "coulomb_friction_scale",
    "rotor_inertia_scale",
    "input_delay",
    "actuator_lag",
    "battery_decline",
    "bridge_coast",
    "bridge_voltage_drop",
    "supply_sag",
    "current_limit",
    "friction_asymmetry",
    "friction_warmup",
    "stribeck_friction",
    "quadratic_drag",
    "gear_backlash",
    "wheel_radius_scale",
    "wheel_radius_asymmetry",
    "wheelbase_scale",
    "turn_slip",
    "encoder_ticks_scale",
    "encoder_missed_ticks",
)
"""Modules of this folder, one effect each, in the order in which they act: scaling of friction comes first."""
