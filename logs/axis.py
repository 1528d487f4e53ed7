"""Axes of a frame, by name."""

from symolo.core.text_enum import TextEnum


class Axis(TextEnum):
    """Axis of a frame; one with a minus points against its coordinate."""

    X = "x"
    Y = "y"
    Z = "z"
    MINUS_X = "-x"
    MINUS_Y = "-y"
    MINUS_Z = "-z"

    @property
    def number(self) -> int:
        """Number of the coordinate, from 0."""
        return "xyz".index(self.value[-1])

    @property
    def sign(self) -> float:
        return -1.0 if self.value.startswith("-") else 1.0
