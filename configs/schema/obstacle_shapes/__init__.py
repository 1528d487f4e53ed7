"""Shapes of obstacles that are neither boxes nor files, one file each. A new shape is one file and its line here."""

from typing import Annotated

from pydantic import Field

from configs.schema.obstacle_shapes.cone import Cone
from configs.schema.obstacle_shapes.cylinder import Cylinder

ObstacleShape = Annotated[
    Cone | Cylinder,
    Field(discriminator="kind"),
]
