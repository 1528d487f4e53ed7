"""Rays a second: the closed form of `physics.arena.rays` against PyBullet's `rayTestBatch`, on the same world and rays.

The rays are those of one update of the three range sensors, from poses along the scenario's start line; both run
in turns in one process on one core, and the ratio is the median over neighbouring pairs.

    python benchmarks/speed/ray_speed.py [--scenario symolo] [--repeats 15]
"""

import argparse
import os
import time
from statistics import median

import numpy as np
import pybullet

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.arena.rays import RayScene
from physics.bullet.world import add_arena, connect
from symolo.arena.geometry import Arena

UPDATES = 100
RAYS = 270
REACH_M = 2.5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--repeats", type=int, default=15)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    loaded = load_scenario(arguments.scenario)
    arena = Arena.from_config(draw_run(loaded, loaded.routes[0].name, 1).arena)
    scene = RayScene(arena)
    client = connect(1000)
    add_arena(client, arena)
    rng = np.random.default_rng(0)
    batches = [rays(rng) for _ in range(UPDATES)]
    lists = [(origins.tolist(), ends.tolist()) for origins, ends in batches]
    ours, bullets, apart_m = [], [], 0.0
    for _ in range(arguments.repeats):
        begin = time.perf_counter()
        hits = [scene.cast(origins, ends) for origins, ends in batches]
        ours.append(time.perf_counter() - begin)
        begin = time.perf_counter()
        answers = [pybullet.rayTestBatch(*pair, numThreads=1, physicsClientId=client) for pair in lists]
        bullets.append(time.perf_counter() - begin)
        fraction = np.array([[ray[2] for ray in answer] for answer in answers])
        apart_m = REACH_M * float(np.median(np.abs(fraction - [hit.fraction for hit in hits])))
    pybullet.disconnect(client)
    count = UPDATES * RAYS
    print(f"{arguments.scenario}: {len(arena.boxes)} boxes and the floor, medians of {arguments.repeats}")
    for name, seconds in (("closed form", median(ours)), ("rayTestBatch", median(bullets))):
        print(f"{name:14s} {1e-6 * count / seconds:6.2f} million rays/s {1e6 * seconds / UPDATES:7.0f} us an update")
    ratios = [bullet / closed for closed, bullet in zip(ours, bullets, strict=True)]
    print(f"ratio {median(ratios):.2f}, of neighbouring pairs {min(ratios):.2f} to {max(ratios):.2f}")
    print(f"median difference of the two {1e3 * apart_m:.4f} mm")


def rays(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return origins and ends, (270, 3) each: three cones of 90 rays from a drawn pose."""
    origin = np.append(rng.uniform(-0.4, 0.4, 2), 0.05)
    heading = rng.uniform(-np.pi, np.pi) + np.repeat([0.0, 0.5 * np.pi, -0.5 * np.pi], RAYS // 3)
    yaw = heading + np.radians(rng.uniform(-12.5, 12.5, RAYS))
    rise = np.radians(rng.uniform(-12.5, 12.5, RAYS))
    along = np.stack([np.cos(yaw) * np.cos(rise), np.sin(yaw) * np.cos(rise), np.sin(rise)], axis=1)
    return np.tile(origin, (RAYS, 1)), origin + REACH_M * along


if __name__ == "__main__":
    main()
