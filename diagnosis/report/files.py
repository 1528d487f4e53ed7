"""The files of a diagnosis, by name: answer, robots, page, plots, and texts for a terminal."""

import json
from collections.abc import Mapping
from contextlib import nullcontext
from types import MappingProxyType

from diagnosis.diagnose import Diagnosis
from diagnosis.extended_robot import FILE
from diagnosis.measured.measurement import Measurement
from diagnosis.posterior.posterior import FILE as POSTERIOR_FILE
from diagnosis.posterior.posterior import posterior_text
from diagnosis.progress import DiagnosisProgress, Phase, unreported
from diagnosis.report.answer import answer
from diagnosis.report.page import page
from diagnosis.report.report_data import report_data
from diagnosis.report.sections import SECTIONS
from diagnosis.report.summary import reasoning, summary
from diagnosis.unseen import csv_text

ANSWER, PAGE, SUMMARY, REASONING = "answer.json", "report.html", "summary.txt", "reasoning.txt"
PLOTS = "plots"


def files(
    diagnosis: Diagnosis,
    *,
    pybullet: bool = False,
    release: Measurement | None = None,
    unseen: Mapping[str, Measurement] = MappingProxyType({}),
    progress: DiagnosisProgress | None = None,
) -> Mapping[str, bytes]:
    """Return the contents by path inside the output folder; the same diagnosis gives the same bytes.

    Args:
        diagnosis: The diagnosis of a measurement.
        pybullet: Whether to simulate the robots with PyBullet too, which may take minutes.
        release: A dataset to compare with the measurement.
        unseen: Inputs of runs without readings, by file name; files with the extended robot's readings are added.
        progress: Receives when the plots begin; by default nobody does.
    """
    with diagnosis.law.registered() if diagnosis.law else nullcontext():
        return _files(diagnosis, pybullet, release, unseen, progress or unreported())


def _files(
    diagnosis: Diagnosis,
    pybullet: bool,  # noqa: FBT001 - options of `files`
    release: Measurement | None,
    unseen: Mapping[str, Measurement],
    progress: DiagnosisProgress,
) -> Mapping[str, bytes]:
    data = report_data(diagnosis, pybullet=pybullet, release=release, unseen=unseen)
    progress.begin(Phase.PLOTS)
    plots = {name: png for section in SECTIONS for name, png in section.plots(data).items()}
    texts = {
        ANSWER: json.dumps(answer(data), indent=2, ensure_ascii=False) + "\n",
        FILE: data.robot.text,
        POSTERIOR_FILE: posterior_text(diagnosis),
        PAGE: page(data, plots),
        SUMMARY: "\n".join(summary(data)) + "\n",
        REASONING: "\n".join(reasoning(data)) + "\n",
    }
    robot = data.robot.config
    texts |= {file.file: file.text for file in (*robot.effect_files, *robot.sensor_files)}
    texts |= {diagnosis.law.file: diagnosis.law.text} if diagnosis.law else {}
    texts |= {prediction.file: csv_text(prediction.columns) for prediction in data.unseen}
    return {name: text.encode() for name, text in texts.items() if text} | {
        f"{PLOTS}/{name}.png": png for name, png in plots.items()
    }
