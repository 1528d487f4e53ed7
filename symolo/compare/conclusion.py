"""What a comparison comes to: one line, an exit code, and what was made differently."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from symolo.compare.folders import FileResult, Verdict
from symolo.compare.likeness import shown_db
from symolo.dataset.bag import read_cpu_classes
from symolo.dataset.documents.metadata import read_metadata

Found = TypeVar("Found")

IDENTICAL, CLOSE, DIFFERENT = 0, 6, 7
"""Exit codes of `symolo compare`."""


@dataclass(frozen=True)
class Conclusion:
    code: int
    text: str

    @classmethod
    def of(cls, results: Sequence[FileResult]) -> "Conclusion":
        count = Counter(result.verdict for result in results)
        total, same = len(results), count[Verdict.IDENTICAL]
        wrong = {verdict: count[verdict] for verdict in (Verdict.DIFFERENT, Verdict.ONLY_A, Verdict.ONLY_B)}
        if any(wrong.values()):
            told = ", ".join(f"{number} {verdict}" for verdict, number in wrong.items() if number)
            return cls(DIFFERENT, f"different: {told}; {_of(same, total)} identical")
        if same == total:
            return cls(IDENTICAL, f"identical: {_files(total)}")
        worst = min((r.likeness.level_db for r in results if r.verdict is Verdict.CLOSE), default=math.inf)
        if math.isinf(worst):
            return cls(
                CLOSE, f"the same values: {_of(same, total)} identical, no number or pixel differs in the others"
            )
        return cls(CLOSE, f"equal within {shown_db(worst)}: {_of(same, total)} identical, the others as like as that")


def made_differently(a: Path, b: Path) -> Iterator[str]:
    """Processors and programs that two datasets, or what lies in them, were not both made by."""
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


def _above(path: Path, read: Callable[[Path], Found]) -> Found | None:
    """What `read` finds in the dataset that a path leads to or into; a run lies two folders below its dataset."""
    return next(filter(None, map(read, (path, *path.absolute().parents[:4]))), None)


def _files(count: int) -> str:
    return "1 file" if count == 1 else f"{count} files"


def _of(count: int, total: int) -> str:
    return f"{count} of {_files(total)}"
