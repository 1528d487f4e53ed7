"""The report as one HTML page that stands alone: what was compared, what is wrong, what that gains, what stays open."""

from collections.abc import Iterator, Mapping, Sequence

from diagnosis.diagnose import Named
from diagnosis.extended_robot import FILE, VARIED_FILE
from diagnosis.inference.gain import Gain
from diagnosis.inference.profile import Interval
from diagnosis.inference.rivals import AS_GOOD, Rival
from diagnosis.measured.overview import summary_line
from diagnosis.report.against import on_page as against
from diagnosis.report.bench_rows import too_large
from diagnosis.report.compared import compared
from diagnosis.report.engines import on_page
from diagnosis.report.findings import Findings, Without
from diagnosis.report.matrix import matrix
from diagnosis.report.quantities import along, interval, meaning, percent, with_error
from diagnosis.report.summary import reasoning
from diagnosis.report.verdict import (
    cause,
    certainty,
    gained,
    headline,
    hints,
    in_a_sentence,
    left_over,
    reach,
    taken_away,
    to_measure,
)
from symolo.pages.markup import Html, picture, table, tag
from symolo.pages.style import STYLE


def page(found: Findings, pictures: Mapping[str, bytes]) -> str:
    """The whole page.

    Args:
        found: What is said.
        pictures: PNG by name: of each observed quantity, `gain` if rows are held out, `unexplained` if there is any,
            `against` if a dataset is held against it, `path` of a drive that PyBullet drove.
    """
    measurement = found.diagnosis.measurement
    parts = [
        tag("h1", "symolo diagnose: ", summary_line(measurement)),
        tag("p", headline(found.diagnosis), class_="verdict"),
        *(tag("p", in_a_sentence(named), class_="glance") for named in found.diagnosis.named),
        tag("p", gained(found)[0], class_="glance"),
        *_section("What was compared", compared(found.diagnosis)),
        *(_section("Against the dataset", against(found.against, pictures["against"])) if found.against else []),
        *_section("The misfit", _misfit(found, pictures)),
        *_section("What differs", _effects(found)),
        *_section("What it gains", _gain(found, pictures)),
        *(_section("By PyBullet", on_page(found.engines, pictures.get("path"))) if found.engines is not None else []),
        *_section("What cannot be told apart, and what to measure", _open(found)),
        *_section("What stays unexplained", _unexplained(found, pictures)),
        *_section("How each effect would show in these data", matrix(found)),
        *_section("The extended robot", _robot(found)),
        *_section("How it was found", [tag("pre", "\n".join(reasoning(found)))]),
    ]
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", f"{measurement.name}: diagnosis"),
        tag("style", Html(STYLE)),
    )
    return f"<!DOCTYPE html>\n{tag('html', head, tag('body', parts), lang='en')}\n"


def _section(title: str, content: Iterator[Html] | list[Html]) -> list[Html]:
    return [tag("h2", title), *content]


def _misfit(found: Findings, pictures: Mapping[str, bytes]) -> Iterator[Html]:
    diagnosis = found.diagnosis
    told = (
        "Left: measured and predicted. Then what each model leaves, in sigmas of the noise: the nominal robot as it "
        "stands, the same with its parameters fitted as far as their tolerances allow"
    )
    told += ", and the extended robot. " if diagnosis.named else ". "
    told += (
        "Dots are rows that were fitted, rings rows held out; triangles lie beyond the panel's edge. Black: median of "
        "a bin and two of its standard errors. Noise alone stays within the grey band 19 times of 20. The nominal "
        "robot's panel has a height of its own; the number above each is its error."
    )
    yield tag("p", told, class_="note")
    covariates = {of.observed: of.covariate for of in found.before}
    for of in diagnosis.evidence.observed:
        seen = f" along {along(covariates[of.name])}, where it shows most" if of.name in covariates else ""
        caption = f"{of.name}{seen}."
        yield tag("figure", picture(pictures[of.name], caption), tag("figcaption", caption))


def _effects(found: Findings) -> Iterator[Html]:
    diagnosis = found.diagnosis
    if not diagnosis.named:
        yield tag("p", "No effect is named: none is needed to explain these data, or none that is known explains them.")
    for named, without in zip(diagnosis.named, found.without, strict=True):
        yield tag("div", _effect(named, without, found.intervals.get(named.name, {})), class_="card")
    if diagnosis.withdrawn:
        names = ", ".join(diagnosis.withdrawn)
        yield tag("p", f"Chosen at first and given up, since it only stood in for what is unexplained: {names}.")
    for name, drop, times in hints(diagnosis):
        text = f"A hint of {name}, too weak to be named: the cost falls by {drop:.1f}. "
        yield tag("p", text, f"About {times:.1f} times as many rows like these would decide.", class_="note")


def _effect(named: Named, without: Without, intervals: Mapping[str, Sequence[Interval]]) -> Iterator[Html]:
    yield tag("h3", tag("code", named.effect.name))
    yield tag("p", f"{meaning(named.effect.kind)} Such a thing comes of: {cause(named)}.")
    units = named.effect.kind.parameters()
    rows = [
        [
            name,
            with_error(value, named.std[name]),
            reach(intervals[name]) if name in intervals else "not held by these data",
            units[name].unit if units[name].unit != "1" else "",
        ]
        for name, value in named.values.items()
    ]
    yield table(["parameter", "value and standard error", "how far it may go", "unit"], rows)
    yield tag("p", tag("strong", "Confidence: "), certainty(named), ".")
    for text in too_large(named):
        yield tag("p", tag("strong", "Too large: "), text, ".", class_="warn")
    yield tag("p", f"Without it, everything else fitted anew, {taken_away(without)}.")


def _gain(found: Findings, pictures: Mapping[str, bytes]) -> Iterator[Html]:
    yield from (tag("p", text) for text in (*gained(found), *found.on_rows))
    if not found.by_quantity:
        return
    rows = [
        [of.name, f"{of.extended.before:.3g}", *_cells(of.calibrated), *_cells(of.extended)] for of in found.by_quantity
    ]
    fitted, extended = "nominal, fitted [σ]", "extended [σ]"
    head = ["quantity", "nominal [σ]", fitted, "gain", extended, "gain"]
    if not found.diagnosis.named:
        head, rows = head[:4], [row[:4] for row in rows]
    yield table(head, rows)
    yield tag("figure", picture(pictures["gain"], "error of each quantity on the rows held out"))
    told = (
        "Errors are root mean squares in sigmas of the noise, without the largest 3 %, over rows that chose and fitted "
        "nothing. Intervals come from drawing whole trials, or blocks of rows, anew."
    )
    yield tag("p", told, class_="note")


def _cells(gain: Gain) -> list[str]:
    return [f"{gain.after:.3g}", f"{percent(gain.value)} ({interval(gain.low, gain.high)})"]


def _open(found: Findings) -> Iterator[Html]:
    diagnosis = found.diagnosis
    for named in diagnosis.named:
        if rivals := [_rival(of) for of in named.standing.rivals]:
            yield tag("h3", "In place of ", tag("code", named.effect.name))
            if not named.standing.ambiguous_with:
                yield tag("p", "Every other effect that comes near explains these data clearly worse.")
            yield table(["effect", "cost more", "told apart"], rivals)
        shows = [[name, excitation] for name, excitation in to_measure(named)]
        if shows:
            yield tag("p", "To tell them apart, log more of what shows each of them:")
            yield table(["effect", "shows in"], shows)
    untestable = diagnosis.candidates.untestable
    if untestable:
        names = ", ".join(untestable)
        yield tag("p", f"These data contain nothing that shows, so that nothing is said of: {names}.")
    if not diagnosis.named and not untestable:
        yield tag("p", "Nothing.")


def _rival(rival: Rival) -> list[str]:
    return [rival.effect.name, f"{rival.worse:+.1f}", "no" if rival.worse < AS_GOOD else "yes"]


def _unexplained(found: Findings, pictures: Mapping[str, bytes]) -> Iterator[Html]:
    left = found.diagnosis.unexplained
    if left is None:
        best = found.diagnosis.adequacy.structures[:1]
        text = "Nothing: along no covariate does what is left show more than chance would"
        yield tag("p", text + (f" (smallest probability of chance, over all tests: {best[0].p:.2g})." if best else "."))
        return
    yield tag("p", left_over(left), class_="warn")
    yield tag("figure", picture(pictures["unexplained"], left_over(left)))


def _robot(found: Findings) -> Iterator[Html]:
    robot = found.robot
    text = "is the robot with what was found, for a scenario or a simulation:"
    yield tag("p", tag("code", FILE), " ", text)
    yield tag("pre", f"symolo simulate smoke --set robot={FILE} --out simulated")
    for gone in robot.left_out:
        text = f"Left out of the file, since no drive can simulate it: {gone.name} ({gone.why})."
        yield tag("p", text, class_="warn")
    if robot.problem:
        yield tag("p", f"It does not drive as it is: {robot.problem}.", class_="warn")
    if robot.varied_text:
        drawn = "draws its effects anew in each run, as far as these data leave them open with all else as fitted."
        yield tag("p", tag("code", VARIED_FILE), " ", drawn)
    yield tag("details", tag("summary", FILE), tag("pre", robot.text))
    if robot.varied_text:
        yield tag("details", tag("summary", VARIED_FILE), tag("pre", robot.varied_text))
