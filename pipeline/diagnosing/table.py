"""Several diagnoses as one table for a terminal."""

import json
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from diagnosis.report.sentences.quantities import percent
from pipeline.diagnosing.diagnose import NamedCase, folder_of
from symolo.core.files.plain_files import FileKind, read_file

MAX_NAME_CHARS = 40


def diagnosis_table(cases: Sequence[NamedCase], out: Path, failed: Collection[str]) -> Iterator[str]:
    """Yield a heading, a line for each case, and a count.

    Args:
        cases: Cases in the order in which they are shown.
        out: Folder that holds the folders of the other cases.
        failed: Names of the cases that failed.
    """
    width = min(MAX_NAME_CHARS, max(len(case.name) for case in cases)) + 2
    yield f"{'case':{width}}{'gain':8}{'95 % interval':22}effects"
    for case in cases:
        if case.name in failed:
            yield f"{case.name:{width}}{'-':8}{'-':22}FAILED, see above"
            continue
        answer = json.loads(read_file(folder_of(case, out, alone=False) / "answer.json", FileKind.DOCUMENT))
        yield f"{case.name:{width}}{_gain(answer)}{_effects(answer)}"
    done = len(cases) - len(failed)
    yield f"{done} of {len(cases)} cases diagnosed; {out / '<case>' / 'report.html'} explains each one"


def _gain(answer: dict[str, Any]) -> str:
    if "heldout_gain" not in answer:
        return f"{'-':8}{'nothing held out':22}"
    low, high = answer["heldout_gain_ci"]
    return f"{percent(answer['heldout_gain']):8}{f'{percent(low)} to {percent(high)}':22}"


def _effects(answer: dict[str, Any]) -> str:
    names = []
    for effect in answer["effects"]:
        rivals = effect.get("ambiguous_with")
        names.append(effect["name"] + (f" (or {', '.join(rivals)})" if rivals else ""))
    if answer["unexplained"]:
        where = answer.get("unexplained_where")
        names.append(f"UNEXPLAINED {where['channel']} along {where['covariate']}" if where else "UNEXPLAINED")
    law = answer.get("discovery", {}).get("law")
    names += [f"law {law}"] if law else []
    return ", ".join(names) or "nothing"
