"""The validation experiment of the line sensor."""
