"""The unit of a heading without a unit in its name, by the motion that it would give."""

import math

import numpy as np
import pytest

from logs.units.heading import guessed_heading_unit

T_S = 0.05 * np.arange(160)
YAW = 0.4 + 0.9 * np.sin(0.5 * T_S)
PLACE_M = np.cumsum(0.16 * 0.05 * np.column_stack((np.cos(YAW), np.sin(YAW))), axis=0)

CONVENTIONS = {
    "along the path": lambda yaw: yaw,
    "of a compass": lambda yaw: (0.5 * math.pi - yaw) % (2.0 * math.pi),
    "from another zero": lambda yaw: yaw + 1.0,
    "backwards, over turns": lambda yaw: yaw + math.pi + 4.0 * math.pi,
}


@pytest.mark.parametrize("unit", ["", "degrees"])
@pytest.mark.parametrize("convention", CONVENTIONS.values(), ids=CONVENTIONS.keys())
def test_headings_of_any_convention_turn_with_the_path_in_their_unit(convention, unit):
    heading = np.degrees(convention(YAW)) if unit else convention(YAW)
    heading = heading + np.random.default_rng(3).normal(0.0, 0.01 * (180.0 / math.pi if unit else 1.0), len(heading))
    guess, reason = guessed_heading_unit(T_S, PLACE_M, heading)
    assert guess == unit
    assert "the path" in reason


@pytest.mark.parametrize("unit", ["", "degrees"])
def test_missing_poses_do_not_matter(unit):
    heading, place_m = np.degrees(YAW) if unit else YAW.copy(), PLACE_M.copy()
    heading[::3], place_m[1::3] = np.nan, np.nan
    guess, reason = guessed_heading_unit(T_S, place_m, heading)
    assert (guess, "follow the path" in reason) == (unit, True)


@pytest.mark.parametrize(
    ("heading", "unit", "reason"),
    [
        (2.0 * T_S, "", "up to 15.9"),  # turns on the spot, counted over turns
        (np.degrees(2.0 * T_S), "degrees", "would turn at 115 rad/s in radians"),
        (np.degrees(0.2 * T_S) + 60.0, "degrees", "begin at 60"),
        (np.degrees(2.0 * T_S + math.pi) % 360.0 - 180.0, "degrees", "jump by 354"),
        (np.rint(np.linspace(1.0, 10.0, len(T_S))), "degrees", "whole numbers up to 10"),
        (np.linspace(1.0, 60.01, len(T_S)), "", "may be degrees, too"),
        (0.0 * T_S + 0.5, "", "up to 0.5"),
        (np.full(len(T_S), np.nan), "", ""),
    ],
)
@pytest.mark.parametrize("place_m", [None, np.zeros((len(T_S), 2))], ids=["without places", "on the spot"])
def test_without_a_path_the_values_and_their_rate_decide(heading, unit, reason, place_m):
    guess, why = guessed_heading_unit(T_S, place_m, heading)
    assert guess == unit
    assert reason in why


def test_noise_of_a_heading_on_a_straight_path_does_not_make_it_degrees():
    place_m = np.column_stack((0.2 * T_S, 0.0 * T_S))
    heading = np.random.default_rng(5).normal(0.0, 0.3, len(T_S))
    assert guessed_heading_unit(T_S, place_m, heading)[0] == ""
