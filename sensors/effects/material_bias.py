"""Ranges of one material that are too long or too short."""

from collections.abc import Iterator
from typing import Annotated, get_args

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import RangeShift
from configs.faults import ConfigFault
from configs.schema.arena import SurfaceName
from configs.schema.base import Fixed, Slug
from sensors.range_view import RangeView
from symolo.core.arrays import Array
from symolo.core.errors import nearest


class MaterialBias(Effect):
    slot = Slot.RANGE
    cause = "light that enters a surface before it returns, the shape of the pulse"
    excitation = "several materials at the same distance"
    setups = (Setup.RANGE_BENCH,)

    # In the simulation, a surface of `physics.arena.surfaces`; on a bench, any name in its list of materials.
    material: Annotated[Slug, Fixed("a name is text")]
    offset_m: RangeShift
    """reading + offset on that one material."""

    def apply(self, reading_m: Array, view: RangeView) -> Array:
        share = view.material_share.get(self.material, np.zeros_like(reading_m))
        return reading_m + self.offset_m * share

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        del in_simulation
        names = get_args(SurfaceName)
        if self.material not in names:
            allowed, close = f"one of {', '.join(names)}", nearest(self.material, names)
            yield ConfigFault(("material",), "no such surface", got=self.material, allowed=allowed, nearest=close)
