"""Effects on the readings and the place of the line sensor."""
