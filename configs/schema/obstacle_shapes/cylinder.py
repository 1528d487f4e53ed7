"""An upright cylinder, such as a can or the leg of a table."""

from typing import Literal

from pydantic import Field

from configs.schema.obstacle_shapes.base import BodyShape
from configs.schema.obstacle_shapes.revolution import solid_of_revolution
from symolo.arena.mesh import TriangleMesh


class Cylinder(BodyShape):
    """An upright cylinder."""

    kind: Literal["cylinder"]
    """Kind of the shape: a cylinder."""
    radius_m: float = Field(default=0.04, ge=0.002, le=10)
    """Radius [m]."""
    height_m: float = Field(default=0.12, ge=0.002, le=20)
    """Height [m]."""

    def triangles(self) -> TriangleMesh:
        top = self.height_m
        return solid_of_revolution([(0.0, 0.0), (self.radius_m, 0.0), (self.radius_m, top), (0.0, top)])
