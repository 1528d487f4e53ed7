"""Effects on the counts of the wheel encoders."""
