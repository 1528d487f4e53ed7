"""Images per second on a graphics card, by the number of processes that share it, and how equal they are to the CPU's.

    python -m benchmarks.render.costs.graphics_card --out trial [--scenario smoke] [--set PATH=VALUE ...]
        [--workers 1 2 4] [--processor N] [--again] [--simulated DIR]

Every row is the whole of `symolo render`, in a folder of its own, after one simulation for all. "from first to last"
leaves out the start of Blender and the building of the scene, and, on a card whose kernels the driver must compile
first, the compiling. `--processor N` renders on N cores too and compares the images; `--again` renders twice on the
card and compares bytes.
"""

import argparse
import shutil
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import cv2
import numpy as np

from pipeline.cli import main as main_of_symolo
from symolo.core.progress import plural


@dataclass(frozen=True)
class Rendered:
    folder: Path
    seconds: float

    def images(self) -> list[Path]:
        return sorted(self.folder.glob(".stages/render/*/*/images/*.jpg"))

    def print_rate(self, name: str) -> None:
        times = sorted(path.stat().st_mtime for path in self.images())
        between = (len(times) - 1) / (times[-1] - times[0])
        whole = len(times) / self.seconds
        rates = f"{whole:6.2f} /s, {between:6.2f} /s from first to last"
        print(f"{name:22} {plural(len(times), 'image')} in {self.seconds:.1f} s: {rates}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--scenario", default="smoke")
    parser.add_argument("--set", nargs="*", default=[], metavar="PATH=VALUE")
    parser.add_argument("--workers", nargs="*", type=int, default=[1, 2, 4], help="processes on the card")
    parser.add_argument("--processor", type=int, default=0, metavar="N", help="cores for images of the processor")
    parser.add_argument("--again", action="store_true")
    parser.add_argument(
        "--simulated", type=Path, help="output of `symolo simulate` with the same scenario and settings"
    )
    options = parser.parse_args()
    settings = [word for value in options.set for word in ("--set", value)]
    simulated = options.simulated or options.out / "simulated"
    if not options.simulated:
        symolo("simulate", options.scenario, *settings, "--out", str(simulated))

    def rendered(device: str, workers: int, name: str) -> Rendered:
        folder = options.out / name
        shutil.copytree(simulated, folder)
        begin = time.monotonic()
        arguments = ("--out", str(folder), "--device", device, "--workers", str(workers))
        symolo("render", options.scenario, *settings, *arguments)
        result = Rendered(folder, time.monotonic() - begin)
        result.print_rate(f"{device}, {plural(workers, 'worker')}")
        return result

    on_card = [rendered("gpu", workers, f"gpu-{workers}") for workers in options.workers]
    for other in on_card[1:]:
        print_equal("one number of processes and another", on_card[0], other)
    if options.again:
        print_equal("the same twice", on_card[0], rendered("gpu", options.workers[0], "gpu-again"))
    if options.processor:
        on_processor = rendered("cpu", options.processor, "cpu")
        print_equal("card and processor", on_card[0], on_processor)
        print_difference(on_card[0], on_processor)


def symolo(*arguments: str) -> None:
    if code := main_of_symolo(arguments):
        sys.exit(code)


def print_equal(name: str, one: Rendered, other: Rendered) -> None:
    pairs = list(zip(one.images(), other.images(), strict=True))
    equal = sum(mine.read_bytes() == theirs.read_bytes() for mine, theirs in pairs)
    print(f"{name}: {equal} of {len(pairs)} images have the same bytes", flush=True)


def print_difference(one: Rendered, other: Rendered) -> None:
    """Print how far the pixels of two devices differ, in units of the 8-bit image."""
    psnr_db, mean, within = [], [], []
    for mine, theirs in zip(one.images(), other.images(), strict=True):
        difference = cv2.imread(str(mine)).astype(float) - cv2.imread(str(theirs))
        psnr_db.append(10 * np.log10(255**2 / max(np.mean(difference**2), 1e-9)))
        mean.append(np.mean(difference))
        within.append(np.mean(np.abs(difference) <= 2))
    print(f"PSNR of one against the other: median {median(psnr_db):.1f} dB, smallest {min(psnr_db):.1f} dB")
    print(f"mean difference: {np.mean(mean):+.3f}, at most {np.max(np.abs(mean)):.3f} of 255 in an image")
    print(f"values within 2 of 255: {np.mean(within):.1%}, smallest {min(within):.1%}", flush=True)


if __name__ == "__main__":
    main()
