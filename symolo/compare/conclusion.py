"""The conclusion of a comparison: one line, an exit code, and the programs and processors that differ."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from symolo.compare.folders import FileResult, Verdict
from symolo.compare.likeness import shown_db
from symolo.core.progress import plural
from symolo.dataset.bag import read_cpu_classes
from symolo.dataset.documents.metadata import read_metadata

Content = TypeVar("Content")

IDENTICAL, CLOSE, DIFFERENT = 0, 6, 7
"""Exit codes of `symolo compare`."""


@dataclass(frozen=True)
class Conclusion:
    """Exit code and line at the end of a comparison."""

    code: int
    text: str

    @classmethod
    def from_results(cls, results: Sequence[FileResult]) -> "Conclusion":
        count = Counter(result.verdict for result in results)
        total, same = len(results), count[Verdict.IDENTICAL]
        files = plural(total, "file")
        wrong = {verdict: count[verdict] for verdict in (Verdict.DIFFERENT, Verdict.ONLY_A, Verdict.ONLY_B)}
        if any(wrong.values()):
            counts = ", ".join(f"{number} {verdict}" for verdict, number in wrong.items() if number)
            return cls(DIFFERENT, f"different: {counts}; {same} of {files} identical")
        if same == total:
            return cls(IDENTICAL, f"identical: {files}")
        worst = min((r.likeness.level_db for r in results if r.verdict is Verdict.CLOSE), default=math.inf)
        if math.isinf(worst):
            return cls(CLOSE, f"the same values: {same} of {files} identical, no number or pixel differs in the others")
        return cls(CLOSE, f"equal within {shown_db(worst)}: {same} of {files} identical")


def made_differently(a: Path, b: Path) -> Iterator[str]:
    """Yield a line for each program and processor that differs between the datasets that hold the two paths."""
    one, other = (" and ".join(_above(path, read_cpu_classes) or ()) for path in (a, b))
    if one and other and one != other:
        yield f"other CPU class, which may decide low bits: {one} in A, {other} in B"
    made_a, made_b = (_above(path, _programs) or {} for path in (a, b))
    for program in dict.fromkeys((*made_a, *made_b)) if made_a and made_b else ():
        one, other = made_a.get(program, "none"), made_b.get(program, "none")
        if one != other:
            yield f"other version of {program}: {one} in A, {other} in B"


def _programs(root: Path) -> dict[str, str]:
    metadata = read_metadata(root)
    return metadata.made_with if metadata else {}


def _above(path: Path, read: Callable[[Path], Content]) -> Content | None:
    """Return what `read` reads from the dataset that holds a path; a run lies two folders below its dataset."""
    return next(filter(None, map(read, (path, *path.absolute().parents[:4]))), None)
