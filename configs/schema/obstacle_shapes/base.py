"""What a shape of an obstacle must be able to do: everything else works with its triangles."""

from abc import abstractmethod

from configs.schema.base import Section
from symolo.arena.mesh import TriangleMesh


class BodyShape(Section):
    """The settings of a shape. Its field `kind` has the name that an arena file uses."""

    @abstractmethod
    def triangles(self) -> TriangleMesh:
        """Return a closed body that stands on the floor, with the middle of its bounding box above the origin."""
