"""All that a comparison of two datasets, runs, folders or files shows."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from symolo.compare.folders import FileResult, Verdict
from symolo.compare.images import is_of_ids
from symolo.compare.settings import ChangedSetting

MAX_SETTINGS = 20
"""Largest number of settings that the command prints."""


@dataclass(frozen=True)
class Comparison:
    """Two paths with the results of their files."""

    a: Path
    b: Path
    tolerance_db: float
    results: Sequence[FileResult]
    made_differently: Sequence[str]
    """A line for each program and processor that differs."""
    settings: Sequence[ChangedSetting]

    @property
    def other_lines(self) -> list[str]:
        """Lines about all that differs besides files, with the first settings; the page and --json have all."""
        more = len(self.settings) - MAX_SETTINGS
        settings = [str(setting) for setting in self.settings[:MAX_SETTINGS]]
        return [*self.made_differently, *settings, *([f"and {more} other settings"] if more > 0 else [])]

    @property
    def unlike(self) -> list[FileResult]:
        """Files with other bytes in both: what a camera sees before ids, and of each the least alike first."""
        both = [result for result in self.results if result.verdict in {Verdict.DIFFERENT, Verdict.CLOSE}]
        return sorted(both, key=lambda result: (is_of_ids(result.name), result.likeness.level_db, result.name))

    def place(self, root: Path, name: str) -> Path:
        """Return the path of a file; two files were compared if `root` is one."""
        return root / name if root.is_dir() else root
