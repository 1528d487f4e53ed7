"""Cost of the coordinator of a Ray cluster for each block, with tasks that do nothing.

python benchmarks/cluster/coordinator.py [--blocks 10000] [--nodes 2]

Starts a cluster of that many nodes of one core on this machine. It prints the processor time of this process and
the wall time, both for a block.
"""

import argparse
import time
from pathlib import Path

from ray.cluster_utils import Cluster

from pipeline.executors import ray as on_ray
from pipeline.work.supervisor import DEFAULT_LIMITS
from pipeline.work.units import RenderUnit

FRAMES = tuple(range(1, 26))


def nothing(unit_json: str, *_limits: float) -> str:
    assert unit_json  # noqa: S101 - it came through
    return on_ray.UnitRecord().model_dump_json()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=10_000)
    parser.add_argument("--nodes", type=int, default=2)
    arguments = parser.parse_args()
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    for _ in range(arguments.nodes):
        cluster.add_node(num_cpus=1, include_dashboard=False)
    on_ray.done_here = nothing
    units = [
        RenderUnit(
            name=f"CW/test_{i}", work="images", job=Path("job.json"), folder=Path("f"), numbers=FRAMES, threads=1
        )
        for i in range(arguments.blocks)
    ]
    events: list[str] = []
    begin, begin_cpu = time.perf_counter(), time.process_time()
    failures = on_ray.OnRay(cluster.address, DEFAULT_LIMITS).do(units, lambda unit, _event: events.append(unit.name))
    wall_s, cpu_s = time.perf_counter() - begin, time.process_time() - begin_cpu
    cluster.shutdown()
    assert not failures and len(events) == arguments.blocks  # noqa: PT018, S101 - every one came back
    cpu_ms, wall_ms = (1e3 * seconds / arguments.blocks for seconds in (cpu_s, wall_s))
    print(f"{arguments.blocks} blocks: {cpu_ms:.2f} ms of this process, {wall_ms:.2f} ms each")


if __name__ == "__main__":
    main()
