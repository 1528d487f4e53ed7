"""`symolo repair` restores the damaged files of a release."""
