"""Cases of the kind motor_steady."""
