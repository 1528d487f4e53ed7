"""`symolo preview`: images of a scenario before anything is simulated."""

from symolo.core.text_enum import TextEnum


class Engine(TextEnum):
    """Renderers of preview images."""

    CYCLES = "cycles"
    FLAT = "flat"
