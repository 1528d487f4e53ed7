"""The slope of a floor is named in a drive whose robot creeps only while the middle of its axle moves.

The log is a closed form: legs straight ahead and turns on the spot, with the creep of the legs alone.
"""

import json
import math

import numpy as np
import pytest

from pipeline.cli import main

ROW_S, DIAMETER_M, TRACK_M, TICKS = 0.05, 0.065, 0.14, 1440
GRADIENT, DIRECTION_RAD = 0.04, 2.0
LEG_ROWS, TURN_ROWS, LEGS = 40, 20, 8
SPEED_M_S, RATE_RAD_S = 0.2, 2.2
NUMBERS = (f"wheel_diameter_m={DIAMETER_M}", f"track_m={TRACK_M}", f"ticks_per_turn={TICKS}")


@pytest.fixture
def log(tmp_path):
    """A drive of 24 s: straight ahead for 2 s and on the spot for 1 s, in turn; noise of 0.5 mm, 2 mrad."""
    speed_m_s = np.tile(np.repeat([SPEED_M_S, 0.0], [LEG_ROWS, TURN_ROWS]), LEGS)
    rate_rad_s = np.tile(np.repeat([0.0, RATE_RAD_S], [LEG_ROWS, TURN_ROWS]), LEGS)
    heading_rad = np.append(0.0, np.cumsum(rate_rad_s * ROW_S))
    ways = [np.append(0.0, np.cumsum(speed_m_s * way(heading_rad[:-1]) * ROW_S)) for way in (np.cos, np.sin)]
    travel_m = np.append(0.0, np.cumsum(speed_m_s * ROW_S))
    x_m, y_m = (
        way + GRADIENT * travel_m * to(DIRECTION_RAD) for way, to in zip(ways, (math.cos, math.sin), strict=True)
    )
    counts = [
        np.rint((travel_m + sense * 0.5 * TRACK_M * heading_rad) * TICKS / (math.pi * DIAMETER_M))
        for sense in (-1.0, 1.0)
    ]
    noise = np.random.Generator(np.random.PCG64(4)).normal(0.0, [5e-4, 5e-4, 2e-3], (len(travel_m), 3))
    poses = np.column_stack([x_m, y_m, heading_rad]) + noise
    lines = ["t_s,enc_left_ticks,enc_right_ticks,x_m,y_m,theta_rad"]
    for row, (x, y, heading) in enumerate(poses):
        lines.append(f"{ROW_S * row:.3f},{counts[0][row]:.0f},{counts[1][row]:.0f},{x:.5f},{y:.5f},{heading:.5f}")
    path = tmp_path / "drive.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_slope_is_named_although_a_turn_on_the_spot_does_not_creep(log, tmp_path):
    numbers = [word for number in NUMBERS for word in ("--set", number)]
    assert main(["case", "init", str(log), "--out", str(tmp_path / "case"), *numbers]) == 0
    assert main(["diagnose", str(tmp_path / "case"), "--out", str(tmp_path / "diagnosis")]) == 0
    answer = json.loads((tmp_path / "diagnosis" / "answer.json").read_bytes())
    assert [effect["name"] for effect in answer["effects"]] == ["floor_slope"]
    assert not answer["unexplained"]
    (slope,) = answer["effects"]
    assert slope["parameters"]["gradient"] == pytest.approx(GRADIENT, abs=4.0 * slope["std"]["gradient"])
    assert slope["parameters"]["direction_rad"] == pytest.approx(DIRECTION_RAD, abs=4.0 * slope["std"]["direction_rad"])
    assert slope["std"]["gradient"] < 0.1 * GRADIENT
