"""Laps in arenas drawn at random; `benchmarks/laps/random_arenas.py` drives many more."""

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.stages.simulate import simulate
from symolo.arena.footprints import Rectangle, overlap
from symolo.arena.geometry import Arena
from symolo.dataset.codes import State


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 3))])
def test_a_random_arena_is_lapped_without_touching_anything(seed):
    spec = draw_run(load_scenario("random_arenas", [f"seed={seed}"]), "Lap", 1)
    outcome = simulate(spec)
    assert outcome.problems == ()
    trajectory = outcome.recording.trajectory
    assert State.AVOID_LEFT in trajectory.state or State.AVOID_RIGHT in trajectory.state
    boxes = [Rectangle(b.center[:2], b.size[:2], b.yaw_rad) for b in Arena.from_config(spec.arena).boxes]
    for x, y, yaw in trajectory.pose:
        body = Rectangle((x, y), (spec.robot.chassis.length_m, spec.robot.chassis.width_m), yaw)
        assert not any(overlap(body, box) for box in boxes)
