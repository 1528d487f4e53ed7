"""Cases of the kind motor_step."""
