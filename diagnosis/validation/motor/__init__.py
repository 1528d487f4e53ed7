"""The validation experiment of the motor."""
