"""The answer for programs: that of the format, and beside it what is known of each effect by taking it away."""

from diagnosis.engine.gain import EngineGain
from diagnosis.inference.gain import Gain
from diagnosis.report.against import in_json
from diagnosis.report.findings import Findings


def answer(found: Findings) -> dict[str, object]:
    """As GAP_FORMAT has it, with `intervals` and `without` where effects are named; ready for JSON."""
    told = found.diagnosis.answer()
    if found.intervals:
        told["intervals"] = {
            effect: {
                name: {f"{of.level:g}": [of.low, of.high] for of in intervals} for name, intervals in numbers.items()
            }
            for effect, numbers in found.intervals.items()
        }
    if found.without:
        told["without"] = {
            of.name: {"cost_rise": of.rise, **_gain("heldout_gain", of.gain), **_gain("adds", of.adds)}
            for of in found.without
        }
    if found.engines is not None and found.engines.engines:
        told["engines"] = {of.engine: _by_engine(of) for of in found.engines.engines}
    if found.against is not None:
        told["against"] = in_json(found.against)
    return told


def _by_engine(of: EngineGain) -> dict[str, object]:
    return _gain("heldout_gain", of.whole) | {
        "errors": {
            each.quantity: {"unit": each.unit, "nominal": each.before, "extended": each.after} for each in of.errors
        }
    }


def _gain(name: str, of: Gain | None) -> dict[str, object]:
    return {} if of is None else {name: of.value, f"{name}_ci": [of.low, of.high]}
