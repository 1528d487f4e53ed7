"""Why images of a real camera differ from those of the simulated one: measurements in them, and their causes."""
