"""Cases of motors on a bench."""
