"""How long `symolo verify` takes on a dataset of many runs, with several versions of the code in turn.

The runs are copies of the small one of `tests/fuzz/corpus`, with 9 rows, 3 images and all annotations, so the figure is
that of many small files. Each line is the processor time and the elapsed time of one whole command; the last ones are
the ratios of processor times in the same round, to those of the first tree.

    python benchmarks/speed/verify_speed.py [--runs 1000] [--times 3] [TREE ...]

TREE is a working tree of the repository, such as one of `git worktree`; this one by default.
"""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[2]
COMMAND = (sys.executable, "-c", "import sys; from pipeline.cli import main; sys.exit(main())", "verify")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trees", nargs="*", type=Path, metavar="TREE", default=[ROOT])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--times", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        files = make_dataset(data, arguments.runs)
        print(f"{arguments.runs} runs, {files} files")
        rounds = [[measured(tree, data) for tree in arguments.trees] for _ in range(arguments.times)]
    for number, tree in enumerate(arguments.trees[1:], start=1):
        ratios = [seconds[number] / seconds[0] for seconds in rounds]
        extent = f"({min(ratios):.2f} to {max(ratios):.2f})"
        print(f"{tree.name}: {median(ratios):.2f} times the time of {arguments.trees[0].name} {extent}")


def make_dataset(root: Path, runs: int) -> int:
    """Write a dataset of so many copies of one run and return its number of files."""
    sys.path.insert(0, str(ROOT))
    from symolo.dataset.manifest import (  # noqa: PLC0415 - after the path
        MANIFEST,
        TAG_MANIFEST,
        manifest,
        released_hashes,
        tag_manifest,
    )

    shutil.copytree(ROOT / "tests/fuzz/corpus/dataset/valid", root, ignore=shutil.ignore_patterns(".stages"))
    metadata = json.loads((root / "metadata.json").read_text())
    (record,) = metadata["runs"]
    metadata["runs"] = [{**record, "run": f"CW/test_{number}"} for number in range(1, runs + 1)]
    (root / "metadata.json").write_text(json.dumps(metadata))
    for number in range(2, runs + 1):
        shutil.copytree(root / "CW/test_1", root / f"CW/test_{number}")
    hashes = released_hashes(root)
    (root / MANIFEST).write_bytes(manifest(hashes))
    (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
    return len(hashes)


def measured(tree: Path, data: Path) -> float:
    """Return the processor time of one command [s], and print how long it took and how it ended."""
    environment = {**os.environ, "PYTHONPATH": str(tree.resolve()), "OPENBLAS_NUM_THREADS": "1"}
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    # Not in a working tree, whose packages would come before those of PYTHONPATH.
    command, place = [*COMMAND, str(data)], data.parent
    ended = subprocess.run(command, env=environment, cwd=place, capture_output=True, text=True, check=False)
    elapsed_s, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    lines = len((ended.stdout + ended.stderr).splitlines())
    times = f"{cpu_s:.1f} s of the processor, {elapsed_s:.1f} s elapsed"
    print(f"{tree.name}: {times}, exit code {ended.returncode}, {lines} lines", flush=True)
    return cpu_s


if __name__ == "__main__":
    main()
