"""Names of the channels of the line sensor, from right to left."""

from typing import Literal

import numpy as np

from symolo.dataset.tables.rows import LINE

CHANNELS = np.array([column.name for column in LINE.columns])
"""(8,), in the order of every array of line readings."""
ChannelName = Literal["L0", "L1", "L2", "L3", "L4", "L5", "L6", "L7"]
