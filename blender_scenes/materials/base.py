"""What a material needs to know of the place that it covers. A material is a function from numbers to a `Surface`."""

from dataclasses import dataclass

from symolo.core.random_streams import stream


@dataclass(frozen=True)
class SurfacePatch:
    """One piece of the scene with a surface of its own."""

    name: str
    """Unique in the scene; also the surface's name."""
    size_m: tuple[float, float]
    """Extent along u and v."""
    seed: int

    def offset(self, pattern: str) -> tuple[float, float]:
        """Where in an endless pattern this piece was cut out, in features."""
        u, v = stream(self.seed, "pattern", self.name, pattern).uniform(0.0, 64.0, 2)
        return float(u), float(v)

    def draw(self, what: str) -> float:
        """A number 0-1 that belongs to this piece."""
        return float(stream(self.seed, "piece", self.name, what).uniform())
