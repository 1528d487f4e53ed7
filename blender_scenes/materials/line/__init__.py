"""Materials of the line on the floor: tape and paint."""
