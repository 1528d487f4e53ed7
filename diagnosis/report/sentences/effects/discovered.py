"""What the search for a law came to, in sentences and for programs."""

from collections.abc import Iterator

from diagnosis.discovery.law import DiscoveredLaw, Discovery
from diagnosis.discovery.search import SIGN_DRAWS
from diagnosis.report.sentences.quantities import along, cost, gain_text, with_error

_CLEAR_FALL = 10.0
"""Fall of the cost of held-out rows, which outliers hardly change, from which these rows show a law."""


def sentences(discovery: Discovery | None) -> Iterator[str]:
    """Yield the sentences about a search; none if there was none."""
    if discovery is None:
        return
    law = discovery.law
    if law is None:
        yield f"No law is proposed: {discovery.reason}."
        return
    yield f"{_structure(law)}. A law describes the data and names no cause; its file is {law.file}."
    yield f"Its numbers are {_numbers(law)}."
    yield f"{_evidence(law)}."
    if law.active and not law.active.is_everywhere:
        yield f"It acts in {law.active.text}."
    if law.ranges:
        yield f"It was seen for {law.seen_for}; beyond, it is a guess."
    yield f"{_rivals(law)}."
    yield f"{_left(law)}."


def entries(discovery: Discovery | None) -> Iterator[tuple[str, str]]:
    """Yield labels and texts for a terminal."""
    if discovery is None:
        return
    law = discovery.law
    if law is None:
        yield "no law", discovery.reason
        return
    yield "curve" if law.is_curve else "law", f"{_structure(law)}: {law.file}"
    for name, value in law.values.items():
        yield f"  {name}", with_error(value, law.std[name], "+-")
    yield "  evidence", _evidence(law)
    if law.active and not law.active.is_everywhere:
        yield "  acts in", law.active.text
    if law.ranges:
        yield "  seen for", law.seen_for
    yield "  rivals", _rivals(law)
    yield "  beside it", _left(law)


def in_json(discovery: Discovery | None) -> dict[str, object]:
    """Return the search under its key in answer.json; empty if there was none."""
    if discovery is None:
        return {}
    law = discovery.law
    if law is None:
        return {"discovery": {"law": None, "reason": discovery.reason}}
    result: dict[str, object] = {
        "law": law.name,
        "file": law.file,
        "slot": str(law.form.place.slot),
        "shape": law.form.shape,
        "covariates": list(law.form.covariates),
        "member": law.form.place.member,
        "parameters": {**dict(law.effect.choices), **law.values},
        "std": dict(law.std),
        "range": {seen.covariate: [seen.low, seen.high] for seen in law.ranges},
        **_active(law),
        "cost_fall": law.fall,
        "chance": law.chance,
        "forms_tried": law.forms_tried,
        "rivals": dict(law.rivals),
        "leaves_structure": law.left is not None,
    }
    if law.heldout_fall is not None:
        result["heldout_cost_fall"] = law.heldout_fall
    if law.gain is not None:
        result |= {"gain": law.gain.value, "gain_ci": [law.gain.low, law.gain.high]}
    return {"discovery": result}


def _active(law: DiscoveredLaw) -> dict[str, object]:
    """Return the samples in which a law acts, under its key; empty if it acts in none by itself."""
    if law.active is None:
        return {}
    active = law.active
    return {
        "active": {
            "fitted": active.fitted,
            "heldout": active.heldout,
            "range": {seen.covariate: [seen.low, seen.high] for seen in active.ranges},
        }
    }


def _structure(law: DiscoveredLaw) -> str:
    words = law.form.words
    if law.is_curve:
        return f"No form with few numbers describes it better than {words}, a cubic spline with a value at each knot"
    return f"{words[0].upper()}{words[1:]} describes what no listed effect explains"


def _numbers(law: DiscoveredLaw) -> str:
    units = {number.name: number.unit for number in law.form.numbers}
    parts = [
        f"{name} = {with_error(value, law.std[name])}{'' if units[name] == '1' else f' {units[name]}'}"
        for name, value in law.values.items()
    ]
    return ", ".join(parts)


def _evidence(law: DiscoveredLaw) -> str:
    text = f"The cost falls by {cost(law.fall)} over the fitted rows"
    if law.heldout_fall is not None:
        text += f" and by {cost(law.heldout_fall)} over the held-out ones"
    if law.gain is not None:
        text += (
            f", where the error falls from {law.gain.before:.3g} to {law.gain.after:.3g} sigma, a gain of "
            f"{gain_text(law.gain)}"
        )
        if law.active and law.active.misses_heldout:
            text += "; it acts in no held-out sample, so that these do not test it"
        elif law.gain.low <= 0.0:
            is_clear = law.heldout_fall is not None and law.heldout_fall >= _CLEAR_FALL
            hidden = "which outliers hide, or the law matters in few of these rows"
            text += f", {hidden if is_clear else 'so that the held-out rows alone do not show it'}"
    as_good = round(law.chance * (SIGN_DRAWS + 1)) - 1
    return (
        f"{text}. It is the best of {law.forms_tried} forms; with random signs of the residuals, some form does as "
        f"well in {as_good or 'none'} of {SIGN_DRAWS} draws"
    )


def _rivals(law: DiscoveredLaw) -> str:
    if not law.rivals:
        return "No other form does nearly as well"
    listed = "; ".join(f"{words} (cost higher by {cost(max(0.0, rise))})" for words, rise in law.rivals)
    return f"These data can hardly distinguish it from {listed}"


def _left(law: DiscoveredLaw) -> str:
    if law.left is None:
        return "Beside it, the residuals have no structure left"
    return f"Beside it, structure remains in {law.left.observed} along {along(law.left.covariate)}"
