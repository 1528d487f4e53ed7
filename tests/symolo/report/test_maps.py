"""Which runs share a map, and how obstacles stand on it."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.arena.geometry import Arena
from symolo.reader.dataset import load
from symolo.report.plots.map import footprints, map_figure
from symolo.report.statistics.maps import RouteMap, route_maps
from symolo.report.statistics.run_facts import run_facts


@pytest.fixture(scope="module")
def facts(painted):
    data = load(painted(settings=["arena.floor.reflectance={uniform: [0.7, 0.9]}"]))
    return [run_facts(run, record, with_path=True) for run, record in zip(data, data.metadata.runs, strict=True)]


def names(maps):
    return [[one.record.run for one in of.runs] for of in maps]


def test_runs_of_a_route_share_a_map_though_the_floor_is_lighter(facts):
    assert facts[0].arena.floor_reflectance != facts[1].arena.floor_reflectance
    maps = route_maps(facts)
    assert names(maps) == [["CW/test_1", "CW/test_2"], ["CCW/test_1"]]
    assert [one.title for one in maps] == ["CW: test_1, test_2", "CCW: test_1"]


def test_a_run_among_other_obstacles_has_a_map_of_its_own(facts):
    other = replace(facts[1], arena=replace(facts[1].arena, boxes=facts[1].arena.boxes[:-1]))
    assert names(route_maps([facts[0], other, facts[2]])) == [["CW/test_1"], ["CW/test_2"], ["CCW/test_1"]]


def test_a_run_without_a_path_is_on_no_map(facts):
    assert names(route_maps([replace(facts[0], path=None), *facts[1:]])) == [["CW/test_2"], ["CCW/test_1"]]


def test_the_farthest_place_off_the_line_is_stated_for_line_following_alone(facts):
    # Rows 32 on are state 0 at x = 0.58 beside the straight x = 0.55; rows 20 to 31, as far away, are avoidance.
    assert [one.farthest_following_m for one in facts] == pytest.approx([0.03] * 3, abs=1e-6)


def test_an_obstacle_that_moves_is_drawn_where_it_is_and_one_that_stands_once():
    arena = Arena.from_config(draw_run(load_scenario("moving"), "CW", 1).arena)
    t_s = np.linspace(0.0, 20.0, 5)
    for box in arena.boxes:
        drawn = list(footprints(box, t_s))
        assert len(drawn) == (5 if box.motion else 1)
        assert drawn[0] == pytest.approx(box.footprint())
        for corners, (x, y, yaw) in zip(drawn, box.poses_at(t_s), strict=False):
            assert corners.mean(axis=0) == pytest.approx([x, y])
            side = corners[1] - corners[0]
            assert np.hypot(*side) == pytest.approx(box.size[0])
            assert np.exp(1j * yaw) == pytest.approx((side[0] + 1j * side[1]) / box.size[0])


@pytest.mark.parametrize("seed", range(5))
def test_no_name_of_an_obstacle_covers_another_one(seed):
    """As Matplotlib draws them, in an arena with many boxes beside each other."""
    loaded = load_scenario("random_arenas", [f"seed={seed}", "arena.generate.max_decoys=10"])
    arena = Arena.from_config(draw_run(loaded, "Lap", 1).arena)
    figure = map_figure(RouteMap("Lap", arena, (), 1.0))
    FigureCanvasAgg(figure).draw()
    boxes = {box.name for box in arena.boxes if box.kind == "obstacle"}
    texts = [text for text in figure.axes[0].texts if text.get_text() in boxes]
    areas = [text.get_window_extent() for text in texts]
    assert len(areas) == len(boxes) > 4
    assert not [
        (one.get_text(), other.get_text())
        for (one, area), (other, next_to) in combinations(zip(texts, areas, strict=True), 2)
        if area.overlaps(next_to)
    ]
