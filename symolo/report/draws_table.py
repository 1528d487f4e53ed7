"""What was drawn for each run, as a table with a strip of marks for each field."""

from collections.abc import Iterator

from symolo.pages.markup import Html, table, tag
from symolo.report.plots.draw_strip import in_words, strip
from symolo.report.statistics.draws import Draw, draws_of
from symolo.report.statistics.facts import ReleaseFacts

_MAX_OPTIONS = 8


def draws_section(facts: ReleaseFacts) -> Iterator[Html]:
    draws = draws_of(facts.runs, facts.metadata.scenario)
    if not draws:
        yield tag("p", "Nothing: the scenario has no distribution, so that all runs of a route have the same numbers.")
        return
    told = (
        f"{len(draws)} fields have a distribution. What is fixed is not shown; side/spec.json of each run has it all. "
        "A value of a material, lamp or covering that a run does not have changes nothing in that run. "
    )
    if len(facts.runs) == 1:
        told += "This is one run, so that there is one draw of each."
        rows = [[tag("td", d.field, class_="field"), in_words(d.asked), _number(d.values[0])] for d in draws]
        made = table(["field", "asked for", "value"], rows, class_="draws")
    else:
        told += "A mark is a run; the grey below is the range that was asked for, of a normal one 2 sd to each side."
        made = table(["field", "asked for", "smallest", "median", "largest", "runs"], _rows(draws), class_="draws")
    yield tag("p", told, class_="note")
    yield made


def _rows(draws: tuple[Draw, ...]) -> Iterator[list[str]]:
    for draw in draws:
        field, asked = tag("td", draw.field, class_="field"), in_words(draw.asked)
        numbers = draw.numbers
        if numbers is None:
            options = [f"{value} {count}" for value, count in draw.counts[:_MAX_OPTIONS]]
            more = f" and {len(draw.counts) - _MAX_OPTIONS} more" if len(draw.counts) > _MAX_OPTIONS else ""
            yield [field, asked, "", "", "", ", ".join(options) + more]
        else:
            ordered = sorted(numbers)
            middle = 0.5 * (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2])
            told = map(_number, (ordered[0], middle, ordered[-1]))
            yield [field, asked, *told, strip(numbers, draw.asked)]


def _number(value: float | str | bool) -> Html:  # noqa: FBT001 - as a scenario holds it
    return tag("td", f"{value:.4g}" if isinstance(value, float) else str(value), class_="n")
