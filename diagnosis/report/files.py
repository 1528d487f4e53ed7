"""The files of a diagnosis, by name: answer, robots, page, pictures, and texts for a terminal."""

import json
from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.diagnose import Diagnosis
from diagnosis.extended_robot import FILE, VARIED_FILE
from diagnosis.measured.measurement import Measurement
from diagnosis.report.answer import answer
from diagnosis.report.findings import Findings, findings
from diagnosis.report.page import page
from diagnosis.report.plots.coverage import against_picture
from diagnosis.report.plots.gain import gain_picture
from diagnosis.report.plots.misfit import misfit_picture
from diagnosis.report.plots.path import path_picture
from diagnosis.report.plots.unexplained import unexplained_picture
from diagnosis.report.summary import reasoning, summary
from diagnosis.unseen import csv_text, unseen_runs

ANSWER, PAGE, SUMMARY, REASONING = "answer.json", "report.html", "summary.txt", "reasoning.txt"
PLOTS = "plots"


def files(
    diagnosis: Diagnosis,
    *,
    pybullet: bool = False,
    release: Measurement | None = None,
    unseen: Mapping[str, Measurement] = MappingProxyType({}),
) -> Mapping[str, bytes]:
    """Contents by path inside the output folder; the same bytes for the same diagnosis. See `findings`.

    Inputs of unseen runs, by file name, are answered with what the extended robot would do.
    """
    found = findings(diagnosis, pybullet=pybullet, release=release)
    pictures = _pictures(found)
    made = {
        ANSWER: json.dumps(answer(found), indent=2, ensure_ascii=False) + "\n",
        FILE: found.robot.text,
        VARIED_FILE: found.robot.varied_text,
        PAGE: page(found, pictures),
        SUMMARY: "\n".join(summary(found)) + "\n",
        REASONING: "\n".join(reasoning(found)) + "\n",
    }
    for name, columns in unseen_runs(diagnosis.measurement, diagnosis.extended, unseen).items():
        made[name] = csv_text(columns)
    return {name: text.encode() for name, text in made.items() if text} | {
        f"{PLOTS}/{name}.png": png for name, png in pictures.items()
    }


def _pictures(found: Findings) -> dict[str, bytes]:
    diagnosis = found.diagnosis
    made = {of.name: misfit_picture(found, k) for k, of in enumerate(diagnosis.evidence.observed)}
    if found.by_quantity:
        made["gain"] = gain_picture(found)
    if found.engines is not None and found.engines.path is not None:
        made["path"] = path_picture(found.engines.path)
    if found.against is not None:
        made["against"] = against_picture(found.against)
    if diagnosis.unexplained is not None:
        made["unexplained"] = unexplained_picture(found, diagnosis.unexplained)
    return made
