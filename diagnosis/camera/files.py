"""The files of a camera identification by name: answer, camera, page, plots, and the text for the terminal."""

import json
from collections.abc import Iterator, Mapping

from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.extended_camera import LOOK, ROBOT, look_file, robot_file
from diagnosis.camera.overlay import edge_misfit, level_misfit, overlay
from diagnosis.camera.sentences import ambiguity, commands, gain_sentence, headline, size, summary
from diagnosis.report.files import ANSWER, PAGE, PLOTS, SUMMARY
from symolo.pages.html import render_page

CAPTIONS = {
    "edges": "Edges of the line in held-out images: measured, and predicted by the nominal and the extended camera.",
    "misfit": "Distance of each measured edge from the predicted one, across the edge.",
    "levels": "Mean levels of small patches of floor and line: measured minus predicted from the simulated images.",
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
        gains=[text for aspect in diagnosis.aspects if (text := gain_sentence(aspect))],
        named=[(named, size(aspect, named, diagnosis), ambiguity(named)) for aspect, named in diagnosis.named],
        plots=[(CAPTIONS[name], png) for name, png in plots.items()],
        parameters=[(aspect.name, _rows(aspect, diagnosis)) for aspect in diagnosis.aspects],
        remains=[(a.name, a.remaining_structure) for a in diagnosis.aspects if a.remaining_structure],
        left_out=diagnosis.left_out,
        commands=commands(diagnosis),
    )


def _rows(aspect: CameraAspect, diagnosis: CameraDiagnosis) -> Iterator[tuple[str, ...]]:
    """Yield name, value, unit, deviation and whether it is named, of each parameter."""
    places = {named.place for named in aspect.selection.named}
    for place, parameter in enumerate(aspect.model.parameters):
        value, sd = aspect.value(place, diagnosis.case)
        unit = "" if parameter.unit == "1" else parameter.unit
        deviation = f"{aspect.fit.x[place]:+.1f}"
        yield parameter.name, f"{value:.4g} +- {sd:.2g}", unit, deviation, "yes" if place in places else ""
