"""Cases of driving robots."""
