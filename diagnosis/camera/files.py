"""The files of a camera identification by name: answer, camera, page, plots, and a text for a terminal."""

import json
from collections.abc import Iterator, Mapping

from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.extended_camera import LOOK, ROBOT, look_file, robot_file
from diagnosis.camera.overlay import edge_misfit, level_misfit, overlay
from diagnosis.camera.sentences import ambiguity, gained, headline, size, summary, use
from diagnosis.report.files import ANSWER, PAGE, PLOTS, SUMMARY
from symolo.pages.html import render_page

CAPTIONS = {
    "edges": "Edges of the line in images held out: measured, by the nominal camera, and by the extended one.",
    "misfit": "How far the measured edges lie from the predicted ones, across the edge.",
    "levels": "Means of small patches of floor and line, against the simulated images of the same places.",
}


def files(diagnosis: CameraDiagnosis) -> Mapping[str, bytes]:
    """Return the contents by path inside the output folder; the same bytes for the same diagnosis."""
    plots = {"edges": overlay(diagnosis), "misfit": edge_misfit(diagnosis), "levels": level_misfit(diagnosis)}
    shown = {name: png for name, png in plots.items() if png}
    made = {
        ANSWER: json.dumps(diagnosis.answer(), indent=2, ensure_ascii=False) + "\n",
        ROBOT: robot_file(diagnosis),
        LOOK: look_file(diagnosis),
        PAGE: page(diagnosis, shown),
        SUMMARY: "\n".join(summary(diagnosis)) + "\n",
    }
    return {name: text.encode() for name, text in made.items() if text} | {
        f"{PLOTS}/{name}.png": png for name, png in shown.items()
    }


def page(diagnosis: CameraDiagnosis, plots: Mapping[str, bytes]) -> str:
    """Return one page that needs no file beside itself."""
    return render_page(
        "diagnosis.camera",
        title=f"{diagnosis.case.name}: images",
        case=diagnosis.case,
        headline=headline(diagnosis),
        gains=[text for part in diagnosis.parts if (text := gained(part))],
        named=[(choice, size(part, choice, diagnosis), ambiguity(choice)) for part, choice in diagnosis.named],
        plots=[(CAPTIONS[name], png) for name, png in plots.items()],
        numbers=[(part.name, _numbers(part, diagnosis)) for part in diagnosis.parts],
        remains=[(part.name, part.remaining_structure) for part in diagnosis.parts if part.remaining_structure],
        left_out=diagnosis.left_out,
        commands=use(diagnosis),
    )


def _numbers(part: CameraAspect, diagnosis: CameraDiagnosis) -> Iterator[tuple[str, ...]]:
    named = {choice.place for choice in part.chosen.choices}
    for place, number in enumerate(part.model.numbers):
        value, sd = part.value(place, diagnosis.case)
        unit = "" if number.unit == "1" else number.unit
        deviation = f"{part.fit.x[place]:+.1f}"
        yield number.name, f"{value:.4g} +- {sd:.2g}", unit, deviation, "yes" if place in named else ""
