"""A controller of the user that probably commands in another unit than m/s."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.run_warnings.commanded_speed import commanded_in_other_units

SPEC = draw_all(load_scenario("smoke"))[0]
OWN = SPEC.model_copy(update={"controller": SimpleNamespace(name="toy")})


def warnings_of(spec, forward):
    """Return the warnings of a run with these forward speeds, which it commands while it turns at 0.5 rad/s."""
    command = np.column_stack((forward, np.full(len(forward), 0.5)))
    recording: Any = {"command": SimpleNamespace(values=command)}
    return list(commanded_in_other_units(spec, recording))


@pytest.mark.parametrize(
    ("speed", "meant"),
    [
        (18.0, "; 18 cm/s would be 0.18 m/s"),
        (-18.0, "; 18 cm/s would be 0.18 m/s"),
        (180.0, "; 180 mm/s would be 0.18 m/s"),
    ],
)
def test_the_unit_that_is_probably_meant_is_named(speed, meant):
    """The nominal robot drives at less than 1 m/s."""
    (text,) = warnings_of(OWN, [0.0, speed, speed, 0.0])
    assert text.startswith(f"the controller toy commands {abs(speed):.3g} m/s (median), and the motors reach ")
    assert text.endswith(f"its commands are probably in another unit than m/s, rad/s or V{meant}")


@pytest.mark.parametrize("forward", [[0.18, 0.2], [1.0, 1.0], [0.0, 0.0], [0.18, 0.18, 30.0]])
def test_full_speed_standing_still_and_single_outliers_are_usual(forward):
    assert warnings_of(OWN, forward) == []


def test_the_built_in_controller_has_a_warning_of_its_own_before_the_run():
    assert warnings_of(SPEC, [18.0, 18.0]) == []
