"""What the three stages of the format predict of a drive, and how far readings are from it."""
