"""Base of effects that act on the ranges of one material."""

from collections.abc import Iterator
from typing import Annotated, get_args

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.schema.arena import SurfaceName
from configs.schema.base import Fixed, Slug
from configs.validation.faults import ConfigFault
from sensors.ranging.range_view import RangeView
from symolo.core.arrays import Array
from symolo.core.errors import nearest


class OfMaterial(Effect):
    """Base of effects that act on the ranges of one material only."""

    slot = Slot.RANGE
    setups = (Setup.RANGE_BENCH,)

    material: Annotated[Slug, Fixed("a name is text")]
    """Material with this error: the surface of a wall or an obstacle in the simulation, a name in the list of materials
    on a bench."""

    def share(self, view: RangeView) -> Array:
        """Return the share of the returned light that comes from the material."""
        return view.material_share.get(self.material, np.zeros_like(view.distance_m))

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        del in_simulation
        names = get_args(SurfaceName)
        if self.material not in names:
            allowed, close = f"one of {', '.join(names)}", nearest(self.material, names)
            yield ConfigFault(("material",), "no such surface", got=self.material, allowed=allowed, nearest=close)
