"""The controller outside of the simulation: its firmware, the board it runs on, and the line between them."""
