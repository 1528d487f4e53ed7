"""Effects on how turns of the wheels become motion: radii, wheel separation, slip and slope."""
