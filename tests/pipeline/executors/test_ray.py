"""Two releases on a Ray cluster of three nodes on this machine, whose workers and one of whose nodes are killed."""

import json
import logging
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.cli import main

SMALL = ["--set=stop.time_limit_s=12", "--set=render.width_px=32", "--set=render.height_px=24"]
SMALL += ["--set=render.samples=1"]
OTHER = "extends: smoke\nname: other\nseed: 7\narena: {extends: moving}\nrender: {annotations: [instance]}\n"

LOG = logging.getLogger(__name__)

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


def _release(scenario, out, *arguments):
    program = "import sys; from pipeline.cli import main; sys.exit(main())"
    command = [sys.executable, "-P", "-c", program, "release", scenario, "--out", str(out), *SMALL, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _journalled(outs):
    """How often each file was put in place, by its path, with the frame that it is of."""
    journals = [path for out in outs for path in (out / ".stages").rglob("*.jsonl")]
    lines = [(path.with_suffix(""), line) for path in journals for line in path.read_text().splitlines()]
    frames = [(folder, json.loads(line)["frame"]) for folder, line in lines]
    return Counter((folder / frame["file"], (folder, frame["number"])) for folder, frame in frames)


def _images(out):
    return sum(1 for _ in (out / ".stages/render").rglob("*.jpg")) if out.exists() else 0


def _wait_for(condition, timeout_s=240.0):
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def _running(beginning):
    """Processes whose command line begins so."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if path.read_bytes().startswith(beginning):
                found.append(int(path.parent.name))
        except OSError:  # gone meanwhile
            continue
    return found


@dataclass(frozen=True)
class Kill:
    written_ns: dict[Path, int]
    """Of each file that stood in a journal then, when it was written."""
    in_flight: int
    """Units that the processes were at that died; each renders one frame at a time."""

    @classmethod
    def now(cls, outs, in_flight):
        return cls({path: path.stat().st_mtime_ns for path, _ in _journalled(outs)}, in_flight)


def test_two_releases_lose_workers_and_a_node_and_are_those_of_one_machine_with_no_frame_made_twice_but_in_flight(
    cluster, tmp_path, release_of
):
    (tmp_path / "other.yaml").write_text(OTHER)
    scenarios = {"smoke": "smoke", "other": str(tmp_path / "other.yaml")}
    outs = [tmp_path / "datasets" / name for name in scenarios]
    outs[0].parent.mkdir()
    address, shelf = ("--executor", "ray", "--address", cluster.address), tmp_path / "shelf"
    upload = {"other": ["--upload", f"file://{shelf}"]}
    started = [_release(scenarios[out.name], out, *address, *upload.get(out.name, [])) for out in outs]
    kills = []
    for images in (6, 20):
        _wait_for(lambda images=images: min(map(_images, outs)) >= images)
        kills.append(Kill.now(outs, in_flight=1))
        os.kill(_running(b"ray::done_here")[0], signal.SIGKILL)
    _wait_for(lambda: min(map(_images, outs)) >= 35)
    kills.append(Kill.now(outs, in_flight=1))
    assert [command.poll() for command in started] == [None, None]
    cluster.remove_node(next(iter(cluster.worker_nodes)), allow_graceful=False)
    for command in started:
        out, err = command.communicate(timeout=600)
        assert command.returncode == 0, err + out
    for (name, scenario), out in zip(scenarios.items(), outs, strict=True):
        alone = tmp_path / "alone" / name
        assert main(["release", scenario, "--out", str(alone), *SMALL, "--workers", "1"]) == 0
        assert release_of(out) == release_of(alone)
    assert release_of(shelf) == release_of(outs[1])
    for kill in kills:  # what was in place and noted then was never touched again
        assert {path: path.stat().st_mtime_ns for path in kill.written_ns} == kill.written_ns
    made = _journalled(outs)
    again = {frame for (_, frame), times in made.items() if times > 1}
    there = [len(kill.written_ns) for kill in kills]
    LOG.info("kills with %s of %d files in place; made again: %s", there, len(made), again)
    assert max(made.values()) <= 1 + len(kills)
    assert len(again) <= sum(kill.in_flight for kill in kills)


@pytest.mark.parametrize(("own", "expected"), [({}, 60_000), ({"RAY_grpc_client_keepalive_timeout_ms": "5000"}, 5_000)])
def test_a_host_that_closes_no_connection_is_waited_for_as_long_as_set(own, expected):
    program = "from pipeline.executors.ray import _ray; _ray(); from ray._raylet import Config"
    program += "; print(Config.grpc_client_keepalive_timeout_ms())"
    command = [sys.executable, "-P", "-c", program]
    ended = subprocess.run(command, env=os.environ | own, capture_output=True, text=True, check=True).stdout
    assert int(ended) == expected


def test_a_missing_cluster_is_reported_in_a_line(tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["--executor", "ray", "--address", "127.0.0.1:1"]
    assert main(["release", "smoke", "--out", str(out), *SMALL, *arguments]) == 5
    err = capsys.readouterr().err
    assert "no Ray cluster" in err
    assert "ray start --head" in err
    assert len(err.strip().splitlines()) < 4
    assert not out.exists()
