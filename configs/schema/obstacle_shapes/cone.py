"""An upright cone, which may be cut off at the top, such as a traffic cone or a flowerpot."""

from typing import Literal

from pydantic import Field

from configs.schema.obstacle_shapes.base import BodyShape
from configs.schema.obstacle_shapes.revolution import solid_of_revolution
from symolo.arena.mesh import TriangleMesh


class Cone(BodyShape):
    """An upright cone, which may be cut off at the top."""

    kind: Literal["cone"]
    """Kind of the shape: a cone."""
    bottom_radius_m: float = Field(default=0.05, ge=0.002, le=10)
    """Radius at the floor [m]."""
    top_radius_m: float = Field(default=0.0, ge=0, le=10)
    """Radius at the top [m]; 0 for a tip."""
    height_m: float = Field(default=0.15, ge=0.002, le=20)
    """Height [m]."""

    def triangles(self) -> TriangleMesh:
        top = self.height_m
        return solid_of_revolution([(0.0, 0.0), (self.bottom_radius_m, 0.0), (self.top_radius_m, top), (0.0, top)])
