"""A release on a Ray cluster of hosts with addresses of their own, one of which is lost in the middle.

python benchmarks/cluster/lost_host.py [--out FOLDER] [--lose kill|cable|blink|nothing] [--blink 20] [--seconds 21]

One host requests the release, one is the head of the cluster, two render with one core each. `kill` kills all
processes of one of these two; `cable` pulls its cable for good, as a power cut would, and `blink` for some seconds.
Each release is compared with one of a single process here. Needs root, and Ray (`pip install "symolo[cluster]"`);
all hosts share this machine's folders.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from hashlib import sha256
from pathlib import Path

from hosts import Host, Network, exit_without_namespaces

PORT = 6379
LOST_AFTER = 60
"""Frames in place."""
PROGRAM = "import sys; from pipeline.cli import main; sys.exit(main())"
TIMEOUT_S = 900


def release(out: Path, seconds: float, *arguments: str) -> list[str]:
    small = [f"--set=stop.time_limit_s={seconds}", "--set=render.width_px=32", "--set=render.height_px=24"]
    small += ["--set=render.samples=1", "--set=render.annotations=[instance]"]
    return [sys.executable, "-P", "-c", PROGRAM, "release", "smoke", "--out", str(out), *small, *arguments]


def frames(out: Path) -> int:
    return sum(1 for _ in (out / ".stages/render").rglob("*.jpg")) if out.exists() else 0


def rendered_again(out: Path) -> int:
    """Return the number of frames that were put in place more than once, according to the journals."""
    journals = (out / ".stages/render").rglob("*.jsonl")
    lines = [(path.parent, line) for path in journals for line in path.read_text().splitlines()]
    put = Counter((folder, json.loads(line)["frame"]["file"]) for folder, line in lines)
    return sum(times - 1 for times in put.values())


def manifest(out: Path) -> str:
    return sha256((out / "manifest-sha256.txt").read_bytes()).hexdigest()


def start_ray(host: Host, *arguments: str, cores: int) -> None:
    ray = str(Path(sys.executable).with_name("ray"))
    options = [f"--node-ip-address={host.address}", f"--num-cpus={cores}", "--disable-usage-stats"]
    host.run(ray, "start", *arguments, *options, "--object-store-memory=100000000")


def print_output(started: subprocess.Popen[str], begin: float) -> None:
    """Print each line of the command with its time."""
    assert started.stdout is not None  # noqa: S101 - a pipe was requested
    for line in started.stdout:
        print(f"    {time.monotonic() - begin:5.1f} s  {line.strip()[:150]}", flush=True)


def with_loss(out: Path, how: str, seconds: float, blink_s: float) -> None:
    network = Network(4)
    try:
        asking, head, *workers = network.hosts
        address = f"{head.address}:{PORT}"
        start_ray(head, "--head", f"--port={PORT}", "--include-dashboard=false", cores=0)
        for worker in workers:
            start_ray(worker, f"--address={address}", cores=1)
        start_ray(asking, f"--address={address}", cores=0)
        begin = time.monotonic()
        command = asking.command(*release(out, seconds, "--executor", "ray", "--address", address))
        started = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        threading.Thread(target=print_output, args=(started, begin), daemon=True).start()
        while started.poll() is None and frames(out) < LOST_AFTER:
            time.sleep(0.1)
        lost_s, there = time.monotonic() - begin, frames(out)
        print(f"    {lost_s:5.1f} s  lost: {how}, with {there} frames", flush=True)
        if how == "kill":
            workers[0].kill()
        elif how != "nothing":
            network.link(workers[0], "down")
        if how == "blink":
            time.sleep(blink_s)
            network.link(workers[0], "up")
        code = started.wait(TIMEOUT_S)
        took = time.monotonic() - begin
        print(f"{how}: lost at {lost_s:.0f} s with {there} frames, exit code {code} at {took:.0f} s", flush=True)
    finally:
        network.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="an empty or new folder, which stays")
    parser.add_argument("--lose", choices=["kill", "cable", "blink", "nothing"], action="append")
    parser.add_argument("--blink", type=float, default=20.0)
    parser.add_argument("--seconds", type=float, default=21.0, help="of each of the two drives")
    arguments = parser.parse_args()
    exit_without_namespaces()
    with tempfile.TemporaryDirectory() as scratch:
        folder = arguments.out or Path(scratch)
        alone = folder / "alone"
        if not (alone / "manifest-sha256.txt").exists():
            subprocess.run(release(alone, arguments.seconds, "--workers", "1"), check=True, stdout=subprocess.DEVNULL)
        for how in arguments.lose or ["kill", "cable", "blink"]:
            out = folder / how
            with_loss(out, how, arguments.seconds, arguments.blink)
            same = "the same bytes" if manifest(out) == manifest(alone) else "OTHER BYTES"
            print(f"{how}: {frames(out)} frames, {rendered_again(out)} twice; {same} as of one process")


if __name__ == "__main__":
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    main()
