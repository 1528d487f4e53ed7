"""Drive effects at the places where only a closed form tells them apart."""

import math

import numpy as np
import pytest

from physics.effects.encoders.encoder_missed_ticks import EncoderMissedTicks


@pytest.mark.parametrize(("side", "index"), [("right", 0), ("left", 1)])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_lost_ticks_set_in_with_a_logistic_edge_of_0_3_rad_s(side, index, direction):
    values = EncoderMissedTicks(side=side, fraction=0.2, threshold_rad_s=4.0)
    for speed, share in ((4.0, 0.5), (4.3, 1.0 / (1.0 + math.exp(-1.0))), (3.7, 1.0 / (1.0 + math.e)), (9.0, 1.0)):
        turned = np.full((1, 2), direction * speed * 0.01)
        kept = (values.apply(turned, 0.01) / turned)[0]
        assert kept[index] == pytest.approx(1.0 - 0.2 * share)
        assert kept[1 - index] == 1.0
