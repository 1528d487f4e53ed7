import numpy as np
import pytest

from physics.arena.rays import RayScene
from physics.bullet.ray_oracle import BATCH, EngineRays


def cast(arena, origin, end):
    hits = RayScene(arena).cast(np.array([origin], dtype=float), np.array([end], dtype=float))
    return hits.fraction[0], hits.surface[0], hits.normal[0].tolist()


def random_rays(count, seed):
    rng = np.random.default_rng(seed)
    origins = np.stack([rng.uniform(-0.4, 0.4, count), rng.uniform(-0.6, 0.6, count), rng.uniform(0.02, 0.1, count)], 1)
    bearing, elevation = rng.uniform(0, 2 * np.pi, count), rng.normal(0, 0.1, count)
    level = np.cos(elevation)
    return origins, origins + 1.5 * np.stack([level * np.cos(bearing), level * np.sin(bearing), np.sin(elevation)], 1)


def test_a_ray_meets_the_near_face_head_on(one_block):
    assert cast(one_block, (0, 0, 0.05), (1, 0, 0.05)) == (pytest.approx(0.3), 1, [-1, 0, 0])


def test_a_ray_from_above_meets_the_lid(one_block):
    assert cast(one_block, (0.35, 0.01, 0.5), (0.35, 0.01, 0.0)) == (pytest.approx(0.8), 1, [0, 0, 1])


def test_a_ray_over_the_block_goes_on_to_the_floor(one_block):
    fraction, surface, normal = cast(one_block, (0, 0, 0.3), (1.2, 0, -0.1))
    assert (fraction, surface, normal) == (pytest.approx(0.75), 0, [0, 0, 1])


def test_a_ray_that_ends_short_or_passes_by_meets_nothing(one_block):
    assert cast(one_block, (0, 0, 0.05), (0.299, 0, 0.05)) == (1.0, -1, [0, 0, 0])
    assert cast(one_block, (0, 0.051, 0.05), (1, 0.051, 0.05)) == (1.0, -1, [0, 0, 0])
    assert cast(one_block, (0, 0, 0.05), (-1, 0, 0.05)) == (1.0, -1, [0, 0, 0])


def test_a_floor_without_boxes_is_still_met(open_floor):
    assert cast(open_floor, (0, 0, 0.1), (1, 0, -0.1)) == (pytest.approx(0.5), 0, [0, 0, 1])


def test_a_ray_from_below_or_level_does_not_meet_the_floor(open_floor):
    assert cast(open_floor, (0, 0, -0.1), (1, 0, 0.1)) == (1.0, -1, [0, 0, 0])
    assert cast(open_floor, (0, 0, 0.1), (1, 0, 0.1)) == (1.0, -1, [0, 0, 0])
    assert cast(open_floor, (0, 0, 0.1), (0, 0, 1.1)) == (1.0, -1, [0, 0, 0])


def test_the_floor_is_met_to_the_last_bits_however_flat_the_ray(open_floor):
    for end_z in (0.0999, 0.05, -0.1, -10.0):
        met, fraction = end_z < 0.0, 0.1 / (0.1 - end_z)
        expected = (pytest.approx(fraction, rel=1e-14), 0) if met else (1.0, -1)
        assert cast(open_floor, (0.3, -0.2, 0.1), (900.0, 500.0, end_z))[:2] == expected


def test_the_normal_turns_with_the_box(arena):
    wall = next(i for i, box in enumerate(arena.boxes) if box.name == "A2")
    fraction, surface, normal = cast(arena, (-0.5, 0.5, 0.05), (-1.0, 0.5, 0.05))
    assert surface == 1 + wall
    # The face runs from (-0.85, 0.90) to (-0.80, 0.15).
    along = np.array([0.05, -0.75]) / np.hypot(0.05, 0.75)
    assert normal == pytest.approx([-along[1], along[0], 0.0])
    assert -0.5 - 0.5 * fraction == pytest.approx(-0.85 + 0.05 * 0.4 / 0.75)


def test_hits_agree_with_the_engine_own_ray_test(arena):
    origins, ends = random_rays(4000, seed=1)
    with EngineRays(arena) as engine:
        theirs = engine.cast(origins, ends)
    hits = RayScene(arena).cast(origins, ends)
    assert set(np.unique(hits.surface)) >= {-1, 0, 1, 2, 3}
    same = hits.surface == theirs.surface
    error_mm = (1500.0 * (hits.fraction - theirs.fraction))[same]
    # What the engine's stepwise ray test is good for: it rounds the edges of boxes.
    assert same.mean() > 0.998
    assert np.abs(error_mm).max() < 5.0
    assert np.sqrt(np.mean(error_mm**2)) < 0.1


def test_every_hit_lies_on_the_surface_it_names(arena):
    origins, ends = random_rays(4000, seed=2)
    hits = RayScene(arena).cast(origins, ends)
    points = origins + hits.fraction[:, None] * (ends - origins)
    assert np.abs(points[hits.surface == 0, 2]).max() < 1e-12
    for index, box in enumerate(arena.boxes):
        c, s = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
        R_WB = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        met = hits.surface == 1 + index
        share = np.abs((points[met] - box.center) @ R_WB) / (0.5 * np.array(box.size))
        assert np.allclose(share.max(axis=1), 1.0, atol=1e-9)
        assert np.all(((ends - origins)[met] * hits.normal[met]).sum(axis=1) < 0.0)


def test_the_engine_casts_more_rays_than_it_takes_at_a_time(one_block):
    origins = np.tile([0.0, 0.0, 0.05], (BATCH + 1, 1))
    ends = np.tile([1.0, 0.0, 0.05], (BATCH + 1, 1))
    ends[-1] = (0.0, 1.0, 0.05)
    with EngineRays(one_block) as engine:
        hits = engine.cast(origins, ends)
    assert hits.fraction[:-1] == pytest.approx(0.3, abs=1e-4)
    assert (hits.fraction[-1], hits.surface[-1], hits.normal[-1].tolist()) == (1.0, -1, [0, 0, 0])
    assert hits.normal[0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-3)
