"""Why images of a real camera differ from those of the simulated one: what is measured in them, and what it says."""
