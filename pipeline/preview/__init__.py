"""`symolo preview`: what the pictures of a scenario would look like, before anything is simulated."""

from symolo.core.text_enum import TextEnum


class Engine(TextEnum):
    """What makes the pictures."""

    CYCLES = "cycles"
    FLAT = "flat"
