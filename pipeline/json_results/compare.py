"""The result of `symolo compare --json`."""

import math
from typing import Literal

from pipeline.json_results.base import JsonPart, JsonResult
from symolo.compare.comparison import Comparison
from symolo.compare.conclusion import CLOSE, DIFFERENT, IDENTICAL, Conclusion
from symolo.compare.folders import FileResult, Verdict

ConclusionName = Literal["identical", "close", "different"]
_CONCLUSIONS: dict[int, ConclusionName] = {IDENTICAL: "identical", CLOSE: "close", DIFFERENT: "different"}
VerdictName = Literal["identical", "close", "follows", "different", "only_in_a", "only_in_b"]
_VERDICTS: dict[Verdict, VerdictName] = {
    Verdict.IDENTICAL: "identical",
    Verdict.CLOSE: "close",
    Verdict.FOLLOWS: "follows",
    Verdict.DIFFERENT: "different",
    Verdict.ONLY_A: "only_in_a",
    Verdict.ONLY_B: "only_in_b",
}


class ComparedFile(JsonPart):
    """Result of the comparison of one file that is in both folders."""

    name: str
    """Path in both folders."""
    verdict: VerdictName
    """close: other bytes that are equal within the tolerance; follows: a list or description of the other files."""
    level_db: float | None
    """Peak over root mean square of the difference, the PSNR of images; null for equal values and if there is no such
    number."""
    what: str
    """Largest difference and its place; of a JSON file, up to five with their keys; empty for an identical file."""

    @classmethod
    def from_result(cls, result: FileResult) -> "ComparedFile":
        level_db = result.likeness.level_db
        return cls(
            name=result.name,
            verdict=_VERDICTS[result.verdict],
            level_db=round(level_db, 4) if math.isfinite(level_db) else None,
            what=result.likeness.what,
        )


class SettingPair(JsonPart):
    """A setting of the scenario that differs between both datasets."""

    setting: str
    """Path in the scenario."""
    a: str
    """Value or distribution in A; "nothing" without the field."""
    b: str
    """Value or distribution in B; "nothing" without the field."""


class CompareResult(JsonResult):
    """How alike two datasets, runs, folders or files are."""

    command: str = "compare"
    """Name of the command."""
    a: str
    """First path, as it was named."""
    b: str
    """Second path, as it was named."""
    tolerance_db: float
    """Level from which files count as equal."""
    conclusion: ConclusionName
    """close: all files are equal within the tolerance."""
    text: str
    """The conclusion in one line."""
    files: int
    """Number of files that were compared."""
    identical: int
    """Number of files with the same bytes."""
    differences: list[ComparedFile]
    """Files with other bytes; all files with --all."""
    made_differently: list[str]
    """A line for each program and processor that differs."""
    settings: list[SettingPair]
    """Settings of the scenarios of two releases that differ."""

    @classmethod
    def from_comparison(cls, comparison: Comparison, *, every: bool) -> "CompareResult":
        results = comparison.results
        conclusion = Conclusion.from_results(results)
        same = sum(result.verdict is Verdict.IDENTICAL for result in results)
        shown = [result for result in results if every or result.verdict is not Verdict.IDENTICAL]
        return cls(
            exit_code=conclusion.code,
            a=str(comparison.a),
            b=str(comparison.b),
            tolerance_db=comparison.tolerance_db,
            conclusion=_CONCLUSIONS[conclusion.code],
            text=conclusion.text,
            files=len(results),
            identical=same,
            differences=[ComparedFile.from_result(result) for result in shown],
            made_differently=list(comparison.made_differently),
            settings=[SettingPair(setting=one.field, a=one.a, b=one.b) for one in comparison.settings],
        )
