"""`symolo preview`: images of a scenario before anything is simulated."""

from enum import StrEnum


class Engine(StrEnum):
    """Renderers of preview images."""

    CYCLES = "cycles"
    FLAT = "flat"
