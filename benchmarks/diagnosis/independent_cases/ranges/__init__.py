"""Cases of range sensors on a bench."""
