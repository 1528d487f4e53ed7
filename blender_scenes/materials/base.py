"""The place that a material covers. A material is a function from numbers and such a place to a `Surface`."""

from dataclasses import dataclass

from symolo.core.random_streams import stream


@dataclass(frozen=True)
class SurfacePatch:
    """A part of the scene with its own surface."""

    name: str
    """Name of the surface, unique in the scene."""
    size_m: tuple[float, float]
    """Size along u and v."""
    seed: int

    def offset(self, pattern: str) -> tuple[float, float]:
        """Draw the place in an endless pattern where this part begins, in features."""
        u, v = stream(self.seed, "pattern", self.name, pattern).uniform(0.0, 64.0, 2)
        return float(u), float(v)

    def draw(self, what: str) -> float:
        """Draw a number from 0 to 1 that belongs to this part."""
        return float(stream(self.seed, "piece", self.name, what).uniform())
