"""Drivetrain, from commanded voltage to wheel motion: motor, bridge, gearbox, friction and the wheel-speed loop."""
