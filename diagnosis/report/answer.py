"""The answer for programs: the keys of GAP_FORMAT, and the results of removing each effect."""

from diagnosis.inference.evidence.sessions import fitted_errors
from diagnosis.inference.gain import Gain
from diagnosis.inference.log_score import LogScoreChange
from diagnosis.inference.naming.file_numbers import agree
from diagnosis.report.dataset_comparison import in_json
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.data import coupled_wheels, early_voltages, predictive
from diagnosis.report.sentences.effects import discovered
from diagnosis.report.sentences.verdict import parameters_off


def answer(data: ReportData) -> dict[str, object]:
    """Return the answer in GAP_FORMAT, with the conclusion, the parameters that are far outside their tolerances, and
    `intervals` and `without` if effects are named.
    """
    result = data.diagnosis.answer() | {"conclusion": str(data.diagnosis.conclusion)}
    result["parameters_off"] = parameters_off.in_json(parameters_off.parameters_off(data.diagnosis.fit))
    result |= early_voltages.in_json(data.diagnosis.early_voltages)
    result |= coupled_wheels.in_json(data.diagnosis.fit)
    result["predictive"] = predictive.in_json(data.predictive)
    result |= discovered.in_json(data.diagnosis.discovery)
    result |= _sessions(data)
    if data.by_case:
        result["cases"] = {part.name: _gain("heldout_gain", part.extended) for part in data.by_case}
    if data.intervals:
        result["intervals"] = {
            effect: {
                name: {f"{interval.level:g}": [interval.low, interval.high] for interval in intervals}
                for name, intervals in parameters.items()
            }
            for effect, parameters in data.intervals.items()
        }
    if data.ablations:
        result["without"] = {
            ablation.name: {
                "cost_rise": ablation.cost_rise,
                **_gain("heldout_gain", ablation.gain),
                **_gain("adds", ablation.effect_gain),
                **_log_score(ablation.log_score),
            }
            for ablation in data.ablations
        }
    result |= _file_numbers(data)
    if data.own_effects:
        result["own_effects"] = {
            tried.name: {"text": tried.text}
            | ({"parameters": {**tried.values}, "std": {**tried.std}, "cost_fall": tried.drop} if tried.values else {})
            for tried in data.own_effects
        }
    result |= _engines(data)
    result |= _unseen(data)
    if data.dataset is not None:
        result["against"] = in_json(data.dataset)
    return result


def _sessions(data: ReportData) -> dict[str, object]:
    """Return the errors of each session; empty if none was fitted."""
    sessions: dict[str, dict[str, object]] = {}
    for each in fitted_errors(data.diagnosis.fit):
        sessions.setdefault(each.session, {})[each.effect] = {each.number: each.value, "std": each.std}
    return {"sessions": sessions} if sessions else {}


def _engines(data: ReportData) -> dict[str, object]:
    """Return the errors of the nominal and the extended robot in each engine; empty if none drove them."""
    if data.engines is None or not data.engines.engines:
        return {}
    engines = {
        engine.engine: _gain("heldout_gain", engine.whole)
        | {
            "errors": {
                error.quantity: {"unit": error.unit, "nominal": error.before, "extended": error.after}
                for error in engine.errors
            }
        }
        for engine in data.engines.engines
    }
    return {"engines": engines}


def _unseen(data: ReportData) -> dict[str, object]:
    """Return where unseen runs leave the ranges in which effects were observed; empty without such runs."""
    if not data.unseen:
        return {}
    unseen = {
        prediction.file: [
            {
                "effect": condition.effect,
                "condition": condition.condition,
                "range": [condition.low, condition.high],
                "furthest": condition.furthest,
                "share": condition.share,
            }
            for condition in prediction.beyond
        ]
        for prediction in data.unseen
    }
    return {"unseen": unseen}


def _file_numbers(data: ReportData) -> dict[str, object]:
    """Return the numbers that the files of named effects state; empty if none does."""
    compared = {
        named.effect.name: {
            "parameters": {number.name: number.value for number in named.file_numbers},
            "std": {number.name: number.std for number in named.file_numbers},
            "standard_errors_apart": {number.name: number.apart for number in named.file_numbers},
            "agree": agree(named.file_numbers),
            "cost_rise_if_held": data.rise_with_file[named.effect.name],
        }
        for named in data.diagnosis.named
        if named.file_numbers
    }
    return {"of_files": compared} if compared else {}


def _gain(name: str, gain: Gain | None) -> dict[str, object]:
    return {} if gain is None else {name: gain.value, f"{name}_ci": [gain.low, gain.high]}


def _log_score(change: LogScoreChange | None) -> dict[str, object]:
    return {} if change is None else {"log_score": change.value, "log_score_ci": [change.low, change.high]}
