"""Give a reader of untrusted files changed inputs until the time is over: `python benchmarks/fuzz.py READER`.

    python benchmarks/fuzz.py [READER ...] [--seconds 60] [--processor] [--seed 0] [--keep DIR] [--corpus DIR]

Each reader runs in a child that may take 2 s of the processor and 500 MB more memory for an input. A reader fails if it
takes more, crashes, or raises anything but the errors of the project, which are one line. Each failing input is made
shorter and saved, one for each fault of the code. Where atheris is installed (`pip install atheris`), it measures which
lines of our code an input reaches and keeps inputs that reach new ones, with `--corpus` for the next command too;
without atheris, an input is kept that is refused for another reason than all before. Measuring makes a reader up to ten
times slower, so an input that takes too long is read once more without it before it counts as a failure.
"""

import argparse
import hashlib
import importlib.util
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tests.fuzz.guard import Outcome

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

HARD_SECONDS = 5
"""Of the processor, after which the system ends a child that is not in Python's own code."""
SHORTER_SECONDS = 2.0
"""Time to make a failing input shorter."""
MAX_KEPT = 3000
OURS = ("symolo", "configs", "diagnosis", "hil", "logs", "pipeline", "physics", "sensors")
"""Packages whose lines atheris counts."""
_NAMED = re.compile(r"[0-9]+|'[^']*'|/\S+")
"""What differs between two messages for the same reason."""
NAMES = (
    "scenario",
    "table",
    "image",
    "panorama",
    "dataset",
    "bag",
    "download",
    "serial",
    "logs",
    "trajectory",
    "signature",
    "mesh",
    "drawing",
    "rosbag",
    "urdf",
    "documents",
    "code",
    "named",
    "mapping",
    "photographs",
    "model",
    "import",
    "case",
    "estimates",
    "about",
    "splits",
    "keys",
    "recordings",
    "diagnoses",
)


@dataclass
class Tally:
    """What a child reports while it works, in a file that outlives it."""

    path: Path
    inputs: int = 0
    kept: int = 0
    lines: dict[str, str] = field(default_factory=dict)
    """Saved file by problem."""

    def write(self) -> None:
        self.path.write_text(json.dumps([self.inputs, self.kept, self.lines]))

    def read(self) -> None:
        if self.path.is_file():
            self.inputs, self.kept, self.lines = json.loads(self.path.read_text())


def main() -> int:
    options = _options()
    if options.child:
        return _child(options)
    names = options.readers or NAMES
    return max(_parent(name, options) for name in names)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"all by default: {', '.join(NAMES)}")
    parser.add_argument("--seconds", type=float, default=60.0, help="for each reader")
    parser.add_argument("--processor", action="store_true", help="count time of the processor, not of the clock")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for failing inputs; tests/fuzz/corpus by default")
    parser.add_argument("--corpus", type=Path, help="folder for inputs that reach new lines; temporary by default")
    parser.add_argument("--without-atheris", action="store_true")
    parser.add_argument("--child", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--again", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if unknown := set(options.readers) - set(NAMES):
        parser.error(f"no reader {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    return options


def _parent(name: str, options: argparse.Namespace) -> int:
    """Start children until the time is over, for an input may end a child, and print the figures."""
    keep = (options.keep or ROOT / "tests" / "fuzz" / "corpus") / name
    begin, begin_processor, seed, deaths = time.monotonic(), _processor_s(), options.seed, 0
    with tempfile.TemporaryDirectory(prefix="symolo-fuzz-") as folder:
        place = Path(folder)
        total = Tally(place / "tally.json")
        inputs = covered = 0
        while (left := options.seconds - _spent(options, begin, begin_processor)) > 0.5:
            command = [
                sys.executable,
                __file__,
                name,
                "--child",
                folder,
                f"--seconds={left}",
                f"--seed={seed}",
                f"--keep={keep}",
                f"--corpus={(options.corpus or place / 'corpus') / name}",
            ]
            command += ["--without-atheris"] if options.without_atheris else []
            command += ["--processor"] if options.processor else []
            with (place / "log").open("wb") as log:
                ended = subprocess.run(command, stdout=log, stderr=log, check=False)
            total.read()
            covered = max(covered, _covered((place / "log").read_text(errors="replace")))
            inputs, seed = inputs + total.inputs, seed + 1
            if ended.returncode == 0:
                break
            deaths += 1
            problem = _death(ended.returncode, place / "log")
            if (place / "input").is_file() and problem not in total.lines:
                total.lines[problem] = _saved(keep, (place / "input").read_bytes())
            total.inputs = 0
            total.write()
            if not inputs and deaths > 3:
                print((place / "log").read_text(errors="replace")[-2000:])
                break
        seconds, processor_s = time.monotonic() - begin, _processor_s() - begin_processor
        for problem, file in list(total.lines.items()):
            if problem.startswith("more than") and not _fails_again(name, Path(file), place):
                Path(file).unlink(missing_ok=True)
                del total.lines[problem]
    print(f"{name}: {inputs} inputs in {seconds:.0f} s ({processor_s:.0f} s of the processor), ", end="")
    places = f"{covered} places of our code reached, " if covered else ""
    print(f"{inputs / processor_s:.0f} per second, {total.kept} kept, {places}{len(total.lines)} failures", flush=True)
    for problem, file in sorted(total.lines.items()):
        print(f"  {problem}: {file}")
    return bool(total.lines)


def _fails_again(name: str, file: Path, place: Path) -> bool:
    """Return whether an input fails in a child that does not measure the coverage."""
    again = Path(tempfile.mkdtemp(dir=place))
    options = ["--child", str(again), "--keep", str(again), "--without-atheris", "--again", str(file)]
    ended = subprocess.run([sys.executable, __file__, name, *options], capture_output=True, check=False)
    tally = Tally(again / "tally.json")
    tally.read()
    return bool(ended.returncode or tally.lines)


def _processor_s() -> float:
    """Return the time of the processor of this process and of its children that have ended."""
    return sum(os.times()[:4])


def _spent(options: argparse.Namespace, begin: float, begin_processor: float) -> float:
    return _processor_s() - begin_processor if options.processor else time.monotonic() - begin


def _covered(log: str) -> int:
    """Return the number of places of our code that libFuzzer has counted; 0 without atheris."""
    return max(map(int, re.findall(r"cov: ([0-9]+)", log)), default=0)


def _death(code: int, log: Path) -> str:
    if code == -signal.SIGXCPU:
        return f"more than {HARD_SECONDS} s in a library"
    last = log.read_text(errors="replace").strip().splitlines()[-1:]
    name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    return f"the process ended with {name}: {' '.join(last)[:200]}"


def _saved(keep: Path, data: bytes) -> str:
    keep.mkdir(parents=True, exist_ok=True)
    path = keep / hashlib.sha256(data).hexdigest()[:12]
    path.write_bytes(data)
    return os.path.relpath(path)


class Session:
    """One child: a reader, its inputs, and what was found."""

    def __init__(self, options: argparse.Namespace) -> None:
        from tests.fuzz.guard import outcome_of  # noqa: PLC0415 - after the hooks that measure the coverage
        from tests.fuzz.mutations import mutated  # noqa: PLC0415
        from tests.fuzz.readers import READERS  # noqa: PLC0415

        self.reader = READERS[options.readers[0]]
        self.place, self.keep, self.options = options.child, options.keep, options
        self.tally = Tally(options.child / "tally.json")
        self.tally.read()
        self.tally.inputs = 0
        work = tempfile.mkdtemp(dir=options.child)
        self.read = self.reader.opened(Path(work))
        self.inputs = [*self.reader.valid(), *self.reader.failed_once]
        self.draw = random.Random(options.seed)  # noqa: S311 - changes of inputs, not secrets
        self._clock = _processor_s if options.processor else time.monotonic
        self._ends = self._clock() + options.seconds
        self._outcome_of, self._mutated = outcome_of, mutated
        self._current = os.open(self.place / "input", os.O_CREAT | os.O_RDWR)

    def is_over(self) -> bool:
        return self._clock() > self._ends

    def outcome(self, data: bytes) -> "Outcome":
        """Return what comes of an input, which is on the disk in case the process does not come back."""
        os.ftruncate(self._current, len(data))
        os.pwrite(self._current, data, 0)
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time()) + HARD_SECONDS + 1, hard))
        self.tally.inputs += 1
        if self.tally.inputs % 50 == 1:
            self.tally.write()
        try:
            return self._outcome_of(self.read, data, self.reader.refusals)
        finally:  # the time of the fuzzer itself, which chooses the next input, is not the reader's
            resource.setrlimit(resource.RLIMIT_CPU, (hard, hard))

    def take(self, data: bytes) -> str:
        """Read an input, save it where it fails in a new way, and return why it was refused."""
        outcome = self.outcome(data)
        problem = outcome.problem
        if problem and problem not in self.tally.lines:
            self.tally.lines[problem] = _saved(self.keep, self._shorter(data, problem))
            self.tally.write()
        return outcome.refusal

    def _shorter(self, data: bytes, problem: str) -> bytes:
        """Return the input without pieces that the problem does not need."""
        ends, size = time.monotonic() + SHORTER_SECONDS, max(1, len(data) // 2)
        while size and time.monotonic() < ends:
            at = 0
            while at < len(data) and time.monotonic() < ends:
                shorter = data[:at] + data[at + size :]
                if self.outcome(shorter).problem == problem:
                    data = shorter
                else:
                    at += size
            size //= 2
        return data

    def changed(self, data: bytes) -> bytes:
        return self._mutated(data, self.inputs, self.draw)

    def by_reasons(self) -> None:
        """Change inputs at random, and keep those that are refused for a new reason."""
        seen: set[str] = set()
        while not self.is_over():
            data = self.changed(self.draw.choice(self.inputs))
            reason = _NAMED.sub("", self.take(data))[:80]
            if reason not in seen and len(self.inputs) < MAX_KEPT:
                seen.add(reason)
                self.inputs.append(data)
                self.tally.kept += 1


def _child(options: argparse.Namespace) -> int:
    fuzzer = None if options.without_atheris else _atheris()
    if fuzzer is None:
        session = Session(options)
    else:
        with fuzzer.instrument_imports(include=list(OURS)):
            session = Session(options)
    from tests.fuzz.guard import limits  # noqa: PLC0415 - as above

    with limits():
        for data in [options.again.read_bytes()] if options.again else session.inputs.copy():
            session.take(data)
        if fuzzer is not None:
            _by_coverage(fuzzer, session)
        elif not options.again:
            session.by_reasons()
    session.tally.write()
    return 0


def _atheris():  # noqa: ANN202 - a module that has no types
    if importlib.util.find_spec("atheris") is None:
        return None
    import atheris  # noqa: PLC0415 # pyright: ignore[reportMissingImports]

    return atheris


def _by_coverage(fuzzer, session: Session) -> None:  # noqa: ANN001 - as above
    """Leave the choice of inputs to libFuzzer, which ends the process."""
    corpus = session.options.corpus
    corpus.mkdir(parents=True, exist_ok=True)
    for number, data in enumerate(session.inputs):
        (corpus / str(number)).write_bytes(data)

    def change(data: bytes, max_size: int, seed: int) -> bytes:
        session.draw.seed(seed)
        new = session.changed(data) if session.draw.random() < 0.8 else fuzzer.Mutate(data, len(data) + 8)
        return new[:max_size]

    def take(data: bytes) -> None:
        session.take(data)
        if session.is_over():
            session.tally.kept = len(list(corpus.iterdir()))
            session.tally.write()
            os._exit(0)

    settings = [
        f"-seed={session.options.seed + 1}",
        "-max_len=1048576",
        "-len_control=0",
        "-timeout=60",
        "-rss_limit_mb=0",
    ]
    fuzzer.Setup([sys.argv[0], *settings, "-handle_xcpu=0", str(corpus)], take, custom_mutator=change)
    fuzzer.Fuzz()


if __name__ == "__main__":
    sys.exit(main())
