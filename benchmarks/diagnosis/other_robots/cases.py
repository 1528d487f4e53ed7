"""Cases of all kinds."""

import zlib
from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.diagnosis.other_robots.draws import categories
from benchmarks.diagnosis.other_robots.drives import case as drives
from benchmarks.diagnosis.other_robots.files import Case
from benchmarks.diagnosis.other_robots.ranges import case as ranges
from benchmarks.diagnosis.other_robots.steady import case as steady
from benchmarks.diagnosis.other_robots.steps import case as steps

KINDS: dict[str, Callable[[np.random.Generator, str], Case | None]] = {
    "motor_steady": steady.make,
    "motor_step": steps.make,
    "tof_bench": ranges.make,
    "drive_log": drives.make,
}
ATTEMPTS = 60


def _make_case(kind: str, category: str, seed: list[int]) -> Case:
    """Return a case of a category, from the first seed that gives one."""
    for attempt in range(ATTEMPTS):
        case = KINDS[kind](np.random.default_rng([*seed, attempt]), category)
        if case is not None:
            return case
    raise RuntimeError(f"no {kind} case of category {category} in {ATTEMPTS} attempts; take another seed")


def make_cases(kind: str, count: int, seed: int) -> Iterator[Case]:
    """Yield cases; the truth of each holds its name. The categories, and so the cases, depend on the count."""
    key = zlib.crc32(kind.encode())
    for number, category in enumerate(categories(np.random.default_rng([seed, key]), count), start=1):
        case = _make_case(kind, category, [seed, key, number])
        case.truth = {"case": f"{kind}_{number:03d}", **case.truth}
        yield case
