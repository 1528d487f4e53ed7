"""The report as one HTML page without other files: what was compared, what is wrong, what the effects gain."""

from collections.abc import Iterator, Mapping

from diagnosis.extended_robot import FILE
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.measured.overview import summary_line
from diagnosis.next_trial.template import without_trials
from diagnosis.posterior.posterior import FILE as POSTERIOR_FILE
from diagnosis.report import dataset_comparison, engines
from diagnosis.report.matrix import matrix_rows
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences import quantities
from diagnosis.report.sentences.data.beyond import BEYOND_SENTENCE, beyond_list
from diagnosis.report.sentences.data.compared import (
    left_out_sentence,
    misfit_caption,
    quantity_rows,
    rows_sentence,
    source_text,
)
from diagnosis.report.sentences.data.early_voltages import early_voltage_sentences
from diagnosis.report.sentences.data.predictive import predictive_sentence
from diagnosis.report.sentences.effects import discovered, file_numbers
from diagnosis.report.sentences.effects.doubts import log_doubts, size_doubts
from diagnosis.report.sentences.effects.hints import hints
from diagnosis.report.sentences.effects.named import certainty, effect_sentences, interval_text, to_measure
from diagnosis.report.sentences.effects.torque_constants import torque_constants
from diagnosis.report.sentences.effects.wheel_sizes import wheel_sizes
from diagnosis.report.sentences.verdict.gain import gain_sentences, without_effect
from diagnosis.report.sentences.verdict.headline import headline, no_effect
from diagnosis.report.sentences.verdict.no_name import why_no_name
from diagnosis.report.sentences.verdict.parameters_off import off_sentences
from diagnosis.report.sentences.verdict.unexplained import nothing_left, unexplained_sentence
from diagnosis.report.summary import reasoning
from symolo.pages.html import render_page


def page(data: ReportData, plots: Mapping[str, bytes]) -> str:
    """Return the whole page.

    Args:
        data: Everything that is shown.
        plots: PNG by name: one for each observed quantity, `gain` if rows are held out, `unexplained` if anything is
            unexplained, `law` if there is one, `against` if a dataset is compared, `path` of a drive that was simulated
            with PyBullet.
    """
    diagnosis = data.diagnosis
    structures = {structure.observed: structure for structure in data.structures}
    return render_page(
        "diagnosis.report",
        title=f"{diagnosis.measurement.name}: diagnosis",
        data=data,
        diagnosis=diagnosis,
        plots=plots,
        source=summary_line(diagnosis.measurement),
        headline=headline(diagnosis),
        early_voltages=early_voltage_sentences(diagnosis),
        numbers_off=off_sentences(diagnosis),
        effect_sentences=[*effect_sentences(diagnosis), *filter(None, [why_no_name(diagnosis)])],
        gain_sentences=gain_sentences(data),
        left_out=left_out_sentence(diagnosis.measured),
        measured=source_text(diagnosis.measurement),
        stages=", ".join(stage.name for stage in diagnosis.evidence.stages),
        rows_sentence=rows_sentence(diagnosis.measurement, diagnosis.evidence),
        quantity_rows=quantity_rows(diagnosis.evidence),
        misfit=[
            (observed.name, misfit_caption(observed.name, structures.get(observed.name), diagnosis.unexplained))
            for observed in diagnosis.evidence.observed
        ],
        effects=[
            (named, ablation, list(_parameter_rows(named, data)))
            for named, ablation in zip(diagnosis.named, data.ablations, strict=True)
        ],
        discovered=list(discovered.sentences(diagnosis.discovery)),
        hints=list(hints(diagnosis)),
        matrix_rows=matrix_rows(data),
        reasoning=reasoning(data),
        as_good=AS_GOOD,
        file=FILE,
        posterior_file=POSTERIOR_FILE,
        beyond_sentence=BEYOND_SENTENCE,
        beyond=list(beyond_list(data.unseen)),
        predictive_sentence=predictive_sentence(data.predictive),
        size_doubts=size_doubts,
        wheel_sizes=wheel_sizes,
        torque_constants=torque_constants,
        log_doubts=log_doubts,
        file_numbers=file_numbers,
        dataset_comparison=dataset_comparison,
        engines=engines,
        quantities=quantities,
        no_effect=no_effect,
        certainty=certainty,
        to_measure=to_measure,
        without_effect=without_effect,
        unexplained_sentence=unexplained_sentence,
        nothing_left=nothing_left,
        without_trials=without_trials(diagnosis.measurement),
    )


def _parameter_rows(named: NamedEffect, data: ReportData) -> Iterator[tuple[str, ...]]:
    intervals, numbers = data.intervals.get(named.effect.name, {}), named.effect.kind.parameters()
    stated = {number.name: file_numbers.file_number(number) for number in named.file_numbers}
    for name, value in named.values.items():
        interval = interval_text(intervals[name]) if name in intervals else "not determined by these data"
        unit = numbers[name].unit
        row = (name, quantities.with_error(value, named.std[name]), interval, "" if unit == "1" else unit)
        yield (*row, stated.get(name, "-")) if stated else row
    for name, value in named.known.items():
        row = (name, f"{value:.3g}", quantities.ASSUMED, "" if numbers[name].unit == "1" else numbers[name].unit)
        yield (*row, "-") if stated else row
