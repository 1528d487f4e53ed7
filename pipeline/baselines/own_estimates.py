"""Estimates of the user's own methods, in files, and their errors in each run."""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path

from pipeline.baselines.base import Estimator
from pipeline.baselines.runs import TrueRun
from symolo.core.errors import FaultList, InputError, nearest
from symolo.core.files.paths import check_path
from symolo.evaluation.align import Align
from symolo.evaluation.association import MAX_GAP_S
from symolo.evaluation.estimate_file import ENDINGS, read_estimate
from symolo.evaluation.evaluate import Evaluation, evaluate_against

OPTION = "--estimate"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}")
_MAX_LISTED = 5
"""Number of runs and warnings that a message names."""
_MAX_COMPARED = 1000
"""Number of names in a folder that are compared with a missing one for a hint."""


@dataclass(frozen=True)
class OwnEstimates(Estimator):
    """The files of one method, which are not part of this project."""

    path: Path
    """File of one run, or folder with a file for each run."""

    def files(self, runs: Sequence[str]) -> dict[str, Path]:
        """Return the file of each of these runs.

        Raises:
            InputError: Runs have none, or several, or the folder cannot be read.
        """
        if not self.path.is_dir():
            if len(runs) != 1:
                cure = f"name a folder with a file for each run, or choose the run with --runs '{runs[0]}'"
                raise InputError(f"is one file for {len(runs)} runs", where=f"{OPTION} {self.path}", cure=cure)
            return {runs[0]: self.path}
        files, missing = {}, []
        for run in runs:
            places = self._files_of(run)
            if len(places) > 1:
                what = f"{places[0].name} and {places[1].name} are both for the run {run}"
                raise InputError(what, where=f"{OPTION} {self.path}", cure="keep one of them")
            if places:
                files[run] = places[0]
            else:
                missing.append(run)
        if missing:
            raise InputError(self._missing(missing), where=f"{OPTION} {self.path}", cure=self._cure(missing[0]))
        return files

    def _files_of(self, run: str) -> list[Path]:
        """Return the files that are where the file of a run may be."""
        stems = (run, run.replace("/", "_"), f"{run}/{self.name}")
        places = [self.path / f"{stem}{ending}" for stem in stems for ending in ENDINGS]
        try:
            return [place for place in places if place.is_file()]
        except OSError as error:
            cure = "check its permissions"
            raise InputError(f"cannot be read: {error.strerror}", where=f"{OPTION} {self.path}", cure=cure) from None

    def _missing(self, runs: Sequence[str]) -> str:
        more = f" and {len(runs) - _MAX_LISTED} more" if len(runs) > _MAX_LISTED else ""
        return f"has no file for {', '.join(runs[:_MAX_LISTED])}{more}"

    def _cure(self, run: str) -> str:
        there: list[str] = []
        # The folder may be the root of a disk, so that only the names in it and in the folders of routes count.
        with suppress(OSError):
            for path in islice(chain(self.path.glob("*"), self.path.glob("*/*")), _MAX_COMPARED):
                there += [path.relative_to(self.path).as_posix()] if path.suffix in ENDINGS else []
        close = nearest(f"{run}.csv", there)
        hint = f"{close} is there; " if close else ""
        return f"{hint}name it {run}.csv or {run}.txt, or choose other runs with --runs"


def own_estimates(texts: Sequence[str], taken: Sequence[str]) -> tuple[OwnEstimates, ...]:
    """Return the methods that options NAME=PATH name; `taken` are the names of the included methods.

    Raises:
        InputError: One is not of this form, its path does not exist or cannot be used, or a name is used twice.
    """
    methods: dict[str, OwnEstimates] = {}
    for text in texts:
        name, equals, path = text.partition("=")
        if not equals or not path or not _NAME.fullmatch(name):
            allowed = "NAME=FILE or NAME=FOLDER, with letters, digits, dots, - and _ in NAME"
            raise InputError(OPTION, got=text, allowed=allowed)
        if name in taken or name in methods or name == "median":
            raise InputError(f"{OPTION} {text}: the name {name} is used already", cure="choose another one")
        check_path(Path(path), OPTION)
        if not Path(path).exists():
            raise InputError("there is no such file or folder", where=f"{OPTION} {path}")
        methods[name] = OwnEstimates(name, name, f"your own estimates, in {Path(path).name}", Path(path))
    return tuple(methods.values())


@dataclass(frozen=True)
class Judgement:
    """The evaluations of own estimates, with the settings that they share."""

    methods: tuple[OwnEstimates, ...]
    evaluations: Mapping[tuple[str, str], Evaluation]
    """Evaluation by the names of run and method."""
    align: Align
    max_gap_s: float

    @property
    def conditions(self) -> str:
        """Sentence about the settings; empty without own estimates."""
        if not self.methods:
            return ""
        how = {
            Align.NONE: "They are not aligned.",
            Align.SE2: "Their places are aligned with the true ones by one turn and one shift for each run.",
            Align.START: "Their first pose in each run is aligned with the true one.",
        }
        names = ", ".join(method.name for method in self.methods)
        gap = f"compared with the row of data.csv nearest in time, at most {1000 * self.max_gap_s:g} ms away"
        return f"The estimates of {names} are {gap}. {how[self.align]}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about suspicious estimates, for the first runs that have one."""
        lines = [
            f"{method}, {run}: {warning}"
            for (run, method), evaluation in self.evaluations.items()
            for warning in evaluation.warnings
        ]
        more = len(lines) - _MAX_LISTED
        return (*lines[:_MAX_LISTED], *([f"{more} more warnings of this kind"] if more > 0 else []))


def judge(
    methods: Sequence[OwnEstimates],
    runs: Sequence[TrueRun],
    *,
    align: Align = Align.NONE,
    max_gap_s: float = MAX_GAP_S,
) -> Judgement:
    """Return the evaluation of each method in each run.

    Raises:
        InputError: Files are missing or have faults; those of all runs are reported together.
    """
    faults, evaluations = FaultList(), {}
    for method in methods:
        with faults.noted():
            files = method.files([run.name for run in runs])
            for run in runs:
                with faults.noted():
                    evaluations[run.name, method.name] = _evaluation(files[run.name], run, align, max_gap_s)
    faults.check()
    return Judgement(tuple(methods), evaluations, align, max_gap_s)


def _evaluation(file: Path, run: TrueRun, align: Align, max_gap_s: float) -> Evaluation:
    trajectory = read_estimate(file)
    try:
        return evaluate_against(run.t_s, run.truth, trajectory, align=align, max_gap_s=max_gap_s)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
