"""A release on a Ray cluster of three nodes on this machine, whose workers and one of whose nodes are killed."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from pipeline.cli import main

SMALL = ["--set=stop.time_limit_s=21", "--set=render.width_px=32", "--set=render.height_px=24"]
SMALL += ["--set=render.samples=1", "--set=render.annotations=[instance]"]

pytestmark = pytest.mark.cluster


@pytest.fixture
def cluster(monkeypatch):
    from ray.cluster_utils import Cluster  # noqa: PLC0415 - of the extra `cluster`

    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    for _ in range(3):
        made.add_node(num_cpus=1, include_dashboard=False)
    yield made
    made.shutdown()


def _release(out, *arguments):
    program = "import sys; from pipeline.cli import main; sys.exit(main())"
    command = [sys.executable, "-P", "-c", program, "release", "smoke", "--out", str(out), *SMALL, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _journals(out):
    return sorted((out / ".stages/render").rglob("*.jsonl"))


def _rendered(out):
    """How often each frame was put in place."""
    lines = [(path.parent.parent.name, line) for path in _journals(out) for line in path.read_text().splitlines()]
    return Counter((run, json.loads(line)["frame"]["file"]) for run, line in lines)


def _frames(out):
    return sum(1 for _ in (out / ".stages/render").rglob("*.jpg")) if out.exists() else 0


def _wait_for(condition, timeout_s=240.0):
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def _workers():
    """Processes in which Ray does our tasks."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if path.read_bytes().startswith(b"ray::done_here"):
                found.append(int(path.parent.name))
        except OSError:  # gone meanwhile
            continue
    return found


def test_killed_workers_and_a_killed_node_change_no_byte_and_cost_no_frame_but_those_in_flight(
    cluster, tmp_path, release_of
):
    alone, shared = tmp_path / "alone", tmp_path / "shared"
    assert main(["release", "smoke", "--out", str(alone), *SMALL, "--workers", "1"]) == 0
    started = _release(shared, "--executor", "ray", "--address", cluster.address)
    kills = 0
    for frames in (10, 60):
        _wait_for(lambda frames=frames: _frames(shared) >= frames or started.poll() is not None)
        assert started.poll() is None, started.communicate()
        os.kill(_workers()[0], signal.SIGKILL)
        kills += 1
    _wait_for(lambda: _frames(shared) >= 90)
    cluster.remove_node(next(iter(cluster.worker_nodes)), allow_graceful=False)
    kills += 1
    out, err = started.communicate(timeout=600)
    assert started.returncode == 0, err + out
    assert release_of(shared) == release_of(alone)
    again = {frame: times - 1 for frame, times in _rendered(shared).items() if times > 1}
    assert sum(again.values()) <= kills


@pytest.mark.parametrize(("own", "expected"), [({}, 60_000), ({"RAY_grpc_client_keepalive_timeout_ms": "5000"}, 5_000)])
def test_a_host_that_closes_no_connection_is_waited_for_as_long_as_set(own, expected):
    program = "from pipeline.executors.ray import _ray; _ray(); from ray._raylet import Config"
    program += "; print(Config.grpc_client_keepalive_timeout_ms())"
    command = [sys.executable, "-P", "-c", program]
    told = subprocess.run(command, env=os.environ | own, capture_output=True, text=True, check=True).stdout
    assert int(told) == expected


def test_a_cluster_that_is_not_there_is_told_in_a_line(tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["--executor", "ray", "--address", "127.0.0.1:1"]
    assert main(["release", "smoke", "--out", str(out), *SMALL, *arguments]) == 5
    err = capsys.readouterr().err
    assert "no cluster of Ray" in err
    assert "ray start --head" in err
    assert len(err.strip().splitlines()) < 4
    assert not out.exists()
