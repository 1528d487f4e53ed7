"""Effects on the readings, times and mounts of range sensors."""
