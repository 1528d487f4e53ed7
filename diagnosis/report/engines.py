"""What PyBullet says of the extended robot, on a terminal and on the page."""

from collections.abc import Iterator

import numpy as np

from diagnosis.engine.base import PYBULLET
from diagnosis.engine.drive import DrivenPath
from diagnosis.engine.gain import ByEngines, EngineError
from diagnosis.inference.gain import Gain
from diagnosis.report.quantities import interval, percent
from symolo.pages.markup import Html, picture, table, tag


def in_lines(found: ByEngines) -> Iterator[str]:
    """A heading, then a line for each quantity."""
    if not found.engines:
        yield f"By PyBullet nothing can be said: {found.why_not}."
        return
    for engine in found.engines:
        yield f"{_told(engine.engine)}: a gain of {_gain(engine.whole)}"
        for of in engine.errors:
            yield f"  {of.quantity:20} {_change(of):32} {_gain(of.gain)}"
    apart = ", ".join(f"{size:.2g} {unit} in {quantity}" for quantity, unit, size in found.apart)
    yield f"The two differ by {apart}."
    if found.path is not None:
        yield path_told(found.path)


def path_told(path: DrivenPath) -> str:
    """How far the driven paths are from the measured one, in a sentence."""
    before, after = (float(np.nanmean(path.off_m(of))) for of in (path.nominal, path.extended))
    lasts = f"{path.t_s[-1] - path.t_s[0]:.0f} s"
    return (
        f"Driven for {lasts} by the voltages alone, the nominal robot is {1e3 * before:.3g} mm off the measured path "
        f"on average, the extended one {1e3 * after:.3g} mm."
    )


def on_page(found: ByEngines, picture_of_path: bytes | None) -> Iterator[Html]:
    """A paragraph, a table, and the paths of a drive as PNG."""
    if not found.engines:
        yield tag("p", f"By PyBullet nothing can be said: {found.why_not}.")
        return
    whole = "; ".join(f"{_told(of.engine)}: a gain of {_gain(of.whole)}" for of in found.engines)
    yield tag("p", f"Driven from rest by the voltages that were measured, over the rows held out. {whole}.")
    rows = [
        [of.quantity, engine.engine, f"{of.before:.3g} {of.unit}", f"{of.after:.3g} {of.unit}", _gain(of.gain)]
        for pair in zip(*(engine.errors for engine in found.engines), strict=True)
        for engine, of in zip(found.engines, pair, strict=True)
    ]
    yield table(["quantity", "by", "nominal", "extended", "gain"], rows)
    apart = ", ".join(f"{size:.2g} {unit} in {quantity}" for quantity, unit, size in found.apart)
    told = (
        f"PyBullet and the twin differ by {apart} for the extended robot: contacts and the weight on wheels and "
        "caster, which the twin has not, and steps of another length. Errors are root mean squares without "
        "the largest 3 %. Unlike in the stage that was fitted, a pose follows from the voltages here, motors and all."
    )
    yield tag("p", told, class_="note")
    if found.path is not None and picture_of_path is not None:
        caption = path_told(found.path)
        yield tag("figure", picture(picture_of_path, caption), tag("figcaption", caption))


def _told(engine: str) -> str:
    return "By PyBullet" if engine == PYBULLET else "by the twin, from the same voltages"


def _gain(of: Gain) -> str:
    return f"{percent(of.value)} ({interval(of.low, of.high)})"


def _change(of: EngineError) -> str:
    return f"{of.before:.3g} to {of.after:.3g} {of.unit}"
