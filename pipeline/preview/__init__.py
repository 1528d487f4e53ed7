"""`symolo preview`: what the pictures of a scenario would look like, before anything is simulated."""

from enum import StrEnum


class Engine(StrEnum):
    """What makes the pictures."""

    CYCLES = "cycles"
    FLAT = "flat"
