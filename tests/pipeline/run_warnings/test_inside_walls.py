"""Obstacles that reach into walls."""

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.references import shipped_names
from pipeline.run_warnings.inside_walls import inside_walls
from pipeline.run_warnings.simulated_run import plan_warnings
from tests.release_fixtures import ONE_ROUTE

WALL = "{name: north, start: [1.5, 2.0], end: [-1.5, 2.0], thickness_m: 0.02}"
"""A wall whose face is at y = 2 m, and whose body is behind it, up to y = 2.02 m."""


def specs_of(obstacle, *settings):
    settings = (ONE_ROUTE, f"arena.walls=[{WALL}]", f"arena.obstacles=[{{name: Box, {obstacle}}}]", *settings)
    return draw_all(load_scenario("smoke", settings))


@pytest.mark.parametrize(
    "obstacle",
    [
        "center: [0.5, 2.0], size: [0.3, 0.2, 0.1]",
        "center: [0.5, 1.91], size: [0.3, 0.2, 0.1]",
        "center: [0.5, 1.89], size: [0.2, 0.2, 0.1], yaw_deg: 45",  # half of its diagonal is 0.141 m
        "center: [1.55, 2.01], size: [0.2, 0.01, 0.1]",
        "center: [0.5, 1.96], shape: {kind: cylinder, radius_m: 0.05}",
        "center: [{uniform: [0.4, 0.5]}, 2.0]",
        "center: [0.5, 2.0], solid: false",
        "center: [0.5, 2.005], size: [0.002, 0.002, 0.1]",
        "center: [0.5, 2.01], size: [0.3, 0.002, 0.1]",
    ],
)
def test_an_obstacle_across_a_wall_is_named_with_its_place(obstacle):
    (warning,) = plan_warnings(specs_of(obstacle))
    assert "obstacle Box at x = " in warning
    assert "stands partly inside wall north" in warning
    assert "move it (arena.obstacles.0.center), or let the wall end there" in warning


@pytest.mark.parametrize(
    "obstacle",
    [
        "center: [0.5, 1.9], size: [0.3, 0.2, 0.1]",  # flush with the face
        "center: [0.5, 1.9005], size: [0.3, 0.2, 0.1]",
        "center: [0.5, 1.999], size: [0.002, 0.002, 0.1]",
        "center: [0.5, 2.12], size: [0.3, 0.2, 0.1]",  # behind the wall
        "center: [1.6, 2.01], size: [0.2, 0.01, 0.1]",  # beside its end
        "center: [0.5, 1.85], size: [0.2, 0.2, 0.1], yaw_deg: 45",
        # Its bounding box reaches into the wall, which a round body does not.
        "center: [0.5, 1.945], yaw_deg: 45, shape: {kind: cylinder, radius_m: 0.05}",
    ],
)
def test_an_obstacle_beside_a_wall_is_usual(obstacle):
    assert list(inside_walls(specs_of(obstacle)[0])) == []


def test_what_range_sensors_do_not_see_is_in_images_alone():
    (solid,) = plan_warnings(specs_of("center: [0.5, 2.0]"))
    (furniture,) = plan_warnings(specs_of("center: [0.5, 2.0], solid: false"))
    assert "images and range sensors see" in solid
    assert "images see" in furniture


@pytest.mark.parametrize("scenario", shipped_names("scenario"))
def test_no_shipped_scenario_has_one(scenario):
    for spec in draw_all(load_scenario(scenario))[:4]:
        assert list(inside_walls(spec)) == []
