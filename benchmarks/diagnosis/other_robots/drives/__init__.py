"""Cases of the kind drive_log."""
