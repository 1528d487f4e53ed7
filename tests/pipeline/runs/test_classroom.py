"""The classroom arena: a cube anywhere on the 1.94 m line is passed and the line found again, both ways round."""

import math

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.stages.simulate import simulate
from symolo.arena.footprints import Rectangle, overlap
from symolo.arena.geometry import Arena
from symolo.dataset.codes import State

STRAIGHT_M, RADIUS_M = 0.50, 0.15
HALF_LAP_M = STRAIGHT_M + math.pi * RADIUS_M
ROUTES = ("CCW", "CW")
AVOIDING = {State.AVOID_LEFT, State.AVOID_RIGHT}
POSITIONS_M = [round((place + 0.5) * HALF_LAP_M / 10, 3) for place in range(10)]
"""Along the line from the start of the lower straight; the other half of the line is the same turned by half a turn."""


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("classroom")


def on_the_line(along_m):
    """x [m], y [m], yaw [rad] counter-clockwise along the first half of the line."""
    if along_m < STRAIGHT_M:
        return along_m - 0.25, -RADIUS_M, 0.0
    angle = (along_m - STRAIGHT_M) / RADIUS_M
    return 0.25 + RADIUS_M * math.sin(angle), -RADIUS_M * math.cos(angle), angle


def start_away_from(along_m, route):
    """On a straight, far enough before the cube to see it in passing."""
    if along_m < STRAIGHT_M:
        return {"CCW": (0.1, 0.15, 180.0), "CW": (-0.1, 0.15, 0.0)}[route]
    return {"CCW": (-0.1, 0.15, 180.0), "CW": (-0.1, -0.15, 180.0)}[route]


def spec_with_cube(scenario, route, along_m):
    x, y, yaw = on_the_line(along_m)
    spec = draw_run(scenario, route, 1)
    cube = spec.arena.obstacles[0].model_copy(update={"center": (x, y), "yaw_deg": math.degrees(yaw)})
    arena = spec.arena.model_copy(update={"obstacles": (cube,)})
    names = ("x_m", "y_m", "yaw_deg")
    start = spec.start.model_copy(update=dict(zip(names, start_away_from(along_m, route), strict=True)))
    return spec.model_copy(update={"arena": arena, "start": start})


def test_the_line_is_1_94_m_long_and_closed_within_walls_of_1_5_and_0_8_m(scenario):
    arena = Arena.from_config(draw_run(scenario, "CCW", 1).arena)
    assert arena.line.length_m == pytest.approx(1.94, abs=0.005)
    assert sorted(piece.length_m for piece in arena.line.pieces)[2:] == pytest.approx([0.5, 0.5])
    ends = [piece.at(np.array([0.0, piece.length_m])) for piece in arena.line.pieces]
    for (_, end), (start, _) in zip(ends, [*ends[1:], ends[0]], strict=True):
        assert end == pytest.approx(start, abs=1e-9)
    walls = [box for box in arena.boxes if box.kind == "wall"]
    assert sorted(wall.size[0] for wall in walls) == pytest.approx([0.8, 0.8, 1.5, 1.5])
    assert [box.size for box in arena.boxes if box.kind == "obstacle"] == [(0.1, 0.1, 0.1)]


@pytest.fixture(scope="module")
def passages(scenario, begun):
    """Specification and its run by the route and the place of the cube."""
    cases = {(route, along_m): spec_with_cube(scenario, route, along_m) for route in ROUTES for along_m in POSITIONS_M}
    return {case: (spec, begun(spec)) for case, spec in cases.items()}


@pytest.mark.parametrize("along_m", POSITIONS_M)
@pytest.mark.parametrize("route", ROUTES)
def test_a_cube_anywhere_on_the_line_is_passed_and_the_line_found_again(passages, route, along_m):
    spec, run = passages[route, along_m]
    outcome = run.result()
    assert outcome.problems == ()
    trajectory = outcome.recording.trajectory
    assert set(trajectory.state.tolist()) <= {State.LINE} | AVOIDING
    assert AVOIDING & set(trajectory.state.tolist())
    assert trajectory.state[-1] == State.LINE
    turned = trajectory.pose[-1, 2] - trajectory.pose[0, 2]
    assert math.copysign(1.0, turned) * math.copysign(1.0, 1.0 if route == "CCW" else -1.0) == 1.0
    chassis = spec.robot.chassis
    boxes = [Rectangle(b.center[:2], b.size[:2], b.yaw_rad) for b in Arena.from_config(spec.arena).boxes]
    for x, y, yaw in trajectory.pose:
        body = Rectangle((x, y), (chassis.length_m, chassis.width_m), yaw)
        assert not any(overlap(body, box) for box in boxes)


def test_the_straight_path_does_not_fit_there():
    """Why there are curve paths: the nominal robot has the straight one alone."""
    outcome = simulate(spec_with_cube(load_scenario("classroom", ["robot=nominal"]), "CCW", 0.25))
    assert not outcome.finished


@pytest.mark.parametrize("route", ROUTES)
def test_the_shipped_laps_are_finished(scenario, route):
    assert simulate(draw_run(scenario, route, 2)).problems == ()
