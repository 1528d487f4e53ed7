"""The array type of the whole tree."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers in double precision; each use states shape and unit."""
