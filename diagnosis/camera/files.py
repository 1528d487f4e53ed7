"""The files of a diagnosis of pictures, by name: answer, camera, page, plots, and a text for a terminal."""

import json
from collections.abc import Iterator, Mapping

from diagnosis.camera.diagnose import PictureDiagnosis
from diagnosis.camera.extended_camera import LOOK, ROBOT, look_file, robot_file
from diagnosis.camera.overlay import edge_misfit, level_misfit, overlay
from diagnosis.camera.sentences import ambiguity, gained, headline, size, summary, use
from diagnosis.report.files import ANSWER, PAGE, PLOTS, SUMMARY
from symolo.pages.markup import Html, picture, table, tag
from symolo.pages.style import STYLE

CAPTIONS = {
    "edges": "Edges of the line in pictures held out: measured, by the nominal camera, and by the extended one.",
    "misfit": "How far the measured edges lie from the predicted ones, across the edge.",
    "levels": "Means of small patches of floor and line, against the simulated pictures of the same places.",
}


def files(diagnosis: PictureDiagnosis) -> Mapping[str, bytes]:
    """Contents by path inside the output folder; the same bytes for the same diagnosis."""
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


def page(diagnosis: PictureDiagnosis, plots: Mapping[str, bytes]) -> str:
    """One page that stands alone."""
    case = diagnosis.case
    seen = (
        f"{len(case.frames)} pictures of {case.size_px[0]} x {case.size_px[1]} px, {int(case.heldout.sum())} held out"
    )
    body = [
        tag("h1", f"symolo pictures: {case.name}, {seen}"),
        tag("p", headline(diagnosis), class_="verdict"),
        *(tag("p", told, class_="glance") for part in diagnosis.parts if (told := gained(part))),
        tag("h2", "What differs"),
        *_named(diagnosis),
        tag("h2", "The misfit"),
        *(
            tag("figure", picture(png, CAPTIONS[name]), tag("figcaption", CAPTIONS[name]))
            for name, png in plots.items()
        ),
        tag("h2", "All numbers"),
        tag("p", "Fitted together, each with a prior of its tolerance but those that are named.", class_="note"),
        *_numbers(diagnosis),
        tag("h2", "What stays open"),
        *_open(diagnosis),
    ]
    if told := use(diagnosis):
        body += [tag("h2", "The extended camera"), tag("pre", "\n".join(told))]
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", f"{case.name}: pictures"),
        tag("style", Html(STYLE)),
    )
    return f"<!DOCTYPE html>\n{tag('html', head, tag('body', body), lang='en')}\n"


def _named(diagnosis: PictureDiagnosis) -> Iterator[Html]:
    if not diagnosis.named:
        yield tag("p", "No number is named: none has to leave its tolerance to explain these pictures.")
    for part, choice in diagnosis.named:
        number, sure = choice.number, min(100 * choice.confidence, 99.9)
        told = [
            tag("h3", tag("code", number.name), f" {size(part, choice, diagnosis)}"),
            tag("p", f"{number.means[0].upper()}{number.means[1:]}. Such a thing comes of: {number.comes_of}."),
            tag("p", f"Confidence {sure:.1f} %; without it the cost rises by {choice.rise:.0f}."),
        ]
        if open_ := ambiguity(choice):
            told.append(tag("p", f"It {open_}.", class_="warn"))
        rivals = [[rival.name, f"{worse:+.1f}"] for rival, worse in choice.rivals[:4]]
        if rivals:
            told.append(table(["in its place", "cost more"], rivals))
        yield tag("div", told, class_="card")


def _numbers(diagnosis: PictureDiagnosis) -> Iterator[Html]:
    for part in diagnosis.parts:
        rows = []
        named = {choice.place for choice in part.chosen.choices}
        for place, number in enumerate(part.model.numbers):
            value, sd = part.found(place, diagnosis.case)
            unit = "" if number.unit == "1" else number.unit
            rows.append(
                [
                    number.name,
                    f"{value:.4g} +- {sd:.2g}",
                    unit,
                    f"{part.fit.x[place]:+.1f}",
                    "yes" if place in named else "",
                ]
            )
        yield tag("h3", part.name)
        yield table(["number", "value", "unit", "tolerances off", "named"], rows)


def _open(diagnosis: PictureDiagnosis) -> Iterator[Html]:
    found = [part for part in diagnosis.parts if part.remains]
    for part in found:
        if part.remains:
            share = 100 * part.remains.share
            text = f"What is left of {part.name} depends on {part.remains.covariate}: {share:.0f} % of its variance."
            yield tag("p", text, class_="warn")
    for what in diagnosis.left_out:
        yield tag("p", f"Not looked at: {what}.")
    if not found and not diagnosis.left_out:
        yield tag("p", "Nothing that a coarse look at columns, rows, levels and time shows.")
