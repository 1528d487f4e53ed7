"""A look from photographs of a floor with a line, of which nobody knows the poses."""
