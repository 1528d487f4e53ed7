"""The page: it stands alone, is well formed for any text in the data, and shows the results."""

import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from math import floor
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.extended_robot import FILE
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.profile import Interval
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure
from diagnosis.measured.measurement import CaseKind
from diagnosis.report.files import ANSWER, PAGE, REASONING, SUMMARY
from diagnosis.report.page import page
from diagnosis.report.plots.gain import round_ticks
from diagnosis.report.report_data import shown_structures
from diagnosis.report.sections.differences import parameter_rows
from diagnosis.report.sentences.data.compared import misfit_caption
from diagnosis.report.sentences.quantities import along
from diagnosis.report.summary import summary
from sensors.effects.range_sensor.tof_range_offset import TofRangeOffset

BENCHES = ("weak", "plain", "bumped")
PNG = b"\x89PNG\r\n\x1a\n"


def text_of(html):
    return " ".join("".join(ET.fromstring(html).itertext()).split())  # noqa: S314 - our own page


@pytest.mark.parametrize("name", BENCHES)
def test_the_page_is_well_formed_and_asks_nobody_for_anything(files_of, name):
    html = files_of(name)[PAGE].decode()
    root = ET.fromstring(html)  # noqa: S314 - our own page
    for element in root.iter():
        assert element.tag not in {"script", "link", "iframe", "object", "form", "base"}
        links = {key: value for key, value in element.attrib.items() if key in {"src", "href", "action", "data"}}
        assert all(value.startswith("data:image/png;base64,") for value in links.values())
        assert not any(key.startswith("on") for key in element.attrib)
    assert re.search(r"https?:|//|@import|url\(", re.sub(r"base64,[^\"]*", "", html)) is None


@pytest.mark.parametrize("name", BENCHES)
def test_every_plot_has_an_alternative_text(files_of, name):
    images = list(ET.fromstring(files_of(name)[PAGE].decode()).iter("img"))  # noqa: S314 - our own page
    plots = {path for path in files_of(name) if path.startswith("plots/")}
    assert len(images) == len(plots) >= 3
    assert all(len(image.attrib["alt"]) > 10 for image in images)
    assert all(files_of(name)[path].startswith(PNG) for path in plots)


def test_an_effect_is_reported_with_value_cause_and_gain(files_of, diagnosis_of):
    text = text_of(files_of("weak")[PAGE].decode())
    (named,) = diagnosis_of("weak").named
    assert named.name == "torque_constant_scale"
    assert "The real robot differs from the nominal one by torque_constant_scale." in text
    assert f"scale = {named.values['scale']:.4f} ± " in text
    assert "Possible causes: a different or an aged magnet, a different gear ratio." in text
    assert "On the held-out rows the error falls from " in text
    assert "but parameters leave their tolerances" in text


def test_what_has_no_name_is_reported_with_channel_covariate_and_plot(files_of, diagnosis_of):
    text = text_of(files_of("bumped")[PAGE].decode())
    left = diagnosis_of("bumped").unexplained
    assert left.channel == "current_A"
    assert f"The residuals of current_A have structure along predicted {left.covariate}" in text
    assert "plots/unexplained.png" in files_of("bumped")
    assert f"current_A along {along(left.covariate)}, where the residuals have the structure that no effect" in text


def test_the_misfit_is_shown_along_the_covariate_of_the_verdict():
    """Along another one only where the verdict is of another quantity, or of a scatter, which has no covariate."""
    of_voltage, of_time = (a_structure(covariate=name, p=1e-9) for name in ("u_cmd_V", "t_s"))
    nominal = Adequacy((of_voltage,))
    assert list(shown_structures(of_time, nominal, ["current_A"])) == [of_time]
    for other in (None, replace(of_time, observed="omega_rad_s"), replace(of_time, what="scatter of 3 times")):
        assert list(shown_structures(other, nominal, ["current_A"])) == [of_voltage]
    assert list(shown_structures(None, Adequacy(()), ["current_A"])) == []


def test_a_caption_speaks_of_structure_only_if_there_is_any():
    certain, chance = a_structure(p=1e-9), a_structure(p=0.2)
    assert misfit_caption("current_A", None, None) == "current_A."
    assert misfit_caption("current_A", chance, None) == "current_A along u_cmd_V."
    assert "nominal robot with fitted parameters show most structure" in misfit_caption("current_A", certain, None)
    assert "that no effect explains" in misfit_caption("current_A", certain, certain)


def a_structure(*, covariate="u_cmd_V", p):
    basis = np.zeros((0, 0))
    return Structure("current_A", "current_A", covariate, "trend", p, 50.0, 0, basis, 1.0, is_over_time=False)


def test_the_table_of_errors_states_how_many_rows_it_leaves_out(files_of, diagnosis_of):
    """GAP_FORMAT keeps the smallest 97 % of the rows, rounded down, so that of few rows more than 3 % are left out."""
    evidence = diagnosis_of("weak").measured
    rows = [int(evidence.heldout[place].sum()) for place in evidence.places]
    count = sum(n - floor(0.97 * n) for n in rows)
    assert count > 0.03 * sum(rows)
    text = text_of(files_of("weak")[PAGE].decode())
    assert f"are left out, rounded up: here {count} of {sum(rows)} values ({100 * count / sum(rows):.3g} %)" in text


def test_a_bench_without_effects_says_so(files_of):
    text = text_of(files_of("plain")[PAGE].decode())
    assert "The nominal simulation explains these data, within the tolerances of its parameters." in text
    assert "plots/unexplained.png" not in files_of("plain")


def test_effects_that_cannot_show_in_steady_states_are_listed(files_of):
    text = text_of(files_of("plain")[PAGE].decode())
    assert re.search(r"nothing is known about them: [^.]*rotor_inertia_scale, [^.]*gear_backlash", text)


HOSTILE = "<b>\"&'</td><script>alert(1)</script>"


def test_markup_in_the_data_is_text(findings_of, files_of):
    data = findings_of("weak")
    measurement = data.diagnosis.measurement
    source = replace(measurement.source, origin=HOSTILE, files=(f"{HOSTILE}.csv",), licence=HOSTILE)
    hostile = replace(measurement, name=HOSTILE, source=source, notes=(HOSTILE,))
    images = {name[6:-4]: data for name, data in files_of("weak").items() if name.startswith("plots/")}
    html = page(replace(data, diagnosis=replace(data.diagnosis, measurement=hostile)), images)
    assert {element.tag for element in ET.fromstring(html).iter()}.isdisjoint({"b", "script"})  # noqa: S314 - our own page
    assert text_of(html).count("alert(1)") >= 4


def test_effects_that_are_not_distinguished_lead_to_the_design_of_the_next_trial(findings_of, files_of):
    data = findings_of("weak")
    (named,) = data.diagnosis.named
    rival = replace(named.comparison.rivals[0], worse=0.0)
    alike = replace(named, comparison=replace(named.comparison, rivals=(rival,)))
    images = {name[6:-4]: data for name, data in files_of("weak").items() if name.startswith("plots/")}
    undecided = replace(data, diagnosis=replace(data.diagnosis, named=(alike,)))
    assert "symolo next DIR --out next" in text_of(page(undecided, images))
    assert "symolo next DIR --out next" in "\n".join(summary(undecided))
    no_case = replace(undecided.diagnosis, measurement=replace(data.diagnosis.measurement, nominal=None))
    no_case = replace(undecided, diagnosis=no_case)
    for text in (text_of(page(no_case, images)), " ".join(" ".join(summary(no_case)).split())):
        assert "symolo next DIR" not in text
        assert "from a log of your own, make a case with `symolo case init LOG`" in text
    case, step = data.diagnosis.measurement, replace(data.diagnosis.measurement, kind=CaseKind.MOTOR_STEP)
    several = replace(undecided.diagnosis, measurement=replace(case, cases=(case, step)))
    several = replace(undecided, diagnosis=several)
    for text in (text_of(page(several, images)), " ".join(" ".join(summary(several)).split())):
        assert "symolo next DIR" not in text
        assert "which are cases of several kinds: diagnose those of one kind alone" in text
    assert "symolo next" not in files_of("weak")[PAGE].decode() + files_of("weak")[SUMMARY].decode()


@pytest.mark.parametrize(
    ("low", "high", "ticks"),
    [(0.64, 5.9, [1.0, 2.0, 5.0]), (0.64, 1.45, [0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4])],
)
def test_a_short_axis_of_errors_has_several_ticks(low, high, ticks):
    assert round_ticks(low, high) == pytest.approx(ticks)


def test_a_unit_that_is_probably_wrong_comes_before_all_results(findings_of, files_of):
    data = findings_of("plain")
    note = "CHECK THE UNIT of omega_rad_s: it is about 57.3 times the no-load speed at its voltage"
    suspected = replace(data.diagnosis.measurement, notes=("not logged: t_s", note))
    doubtful = replace(data, diagnosis=replace(data.diagnosis, measurement=suspected))
    images = {name[6:-4]: data for name, data in files_of("plain").items() if name.startswith("plots/")}
    for text in (" ".join(summary(doubtful)), text_of(page(doubtful, images))):
        assert note in text
        assert text.index(note) < text.index("The nominal simulation explains these data")
    assert "If the log is wrong there" not in files_of("plain")[SUMMARY].decode()


def test_the_answer_is_that_of_the_format(files_of):
    answer = json.loads(files_of("weak")[ANSWER])
    (effect,) = answer["effects"]
    assert effect.keys() == {"name", "parameters", "std", "confidence", "ambiguous_with", "range"}
    assert effect["parameters"]["scale"] == pytest.approx(0.9, abs=3 * effect["std"]["scale"])
    assert answer["unexplained"] is False
    assert answer["heldout_gain_ci"][0] <= answer["heldout_gain"] <= answer["heldout_gain_ci"][1]


@pytest.mark.parametrize("name", BENCHES)
def test_texts_fit_a_terminal(files_of, name):
    summary = files_of(name)[SUMMARY].decode()
    assert max(map(len, summary.splitlines())) <= 120
    assert summary.isascii()
    assert "Selection: " in files_of(name)[REASONING].decode()
    assert files_of(name)[FILE].startswith(b"# The robot that symolo diagnose fitted to ")


def test_each_effect_is_taken_away_in_turn(files_of, findings_of):
    """What is left without an effect and what that effect takes of it make up the whole gain; here the nominal torque
    constant can deviate as far, which costs, and the page reports it."""
    answered = json.loads(files_of("weak")[ANSWER])["without"]["torque_constant_scale"]
    assert answered["cost_rise"] > 100.0
    assert answered["heldout_gain_ci"][0] <= answered["heldout_gain"] <= answered["heldout_gain_ci"][1]
    (without,) = findings_of("weak").ablations
    alone = findings_of("weak").diagnosis.gain
    assert 1.0 - alone.value == pytest.approx((1.0 - without.gain.value) * (1.0 - without.effect_gain.value))
    assert answered["adds_ci"][0] <= answered["adds"] <= answered["adds_ci"][1]
    low, high = json.loads(files_of("weak")[ANSWER])["intervals"]["torque_constant_scale"]["scale"]["0.95"]
    assert low < 0.9 < high
    page_text = text_of(files_of("weak")[PAGE].decode())
    assert "Without this effect and with everything else fitted again, the cost rises by" in page_text
    assert "parameters leave their tolerances (torque_constant_N_m_A by " in page_text
    assert "95 % profile interval 0.8" in files_of("weak")[SUMMARY].decode()


def test_an_effect_of_one_sensor_has_its_interval():
    """The intervals are those of the effect with its choice, such as `tof_range_offset[right]`."""
    effect = CandidateEffect(TofRangeOffset, (("sensor", "right"),))
    named: Any = SimpleNamespace(
        name=effect.kind.name,
        effect=effect,
        values={"offset_m": 0.00287},
        std={"offset_m": 1e-4},
        known={},
        file_numbers=(),
    )
    intervals = {effect.name: {"offset_m": (Interval(0.95, 0.00263, 0.00311, is_open=False),)}}
    data: Any = SimpleNamespace(intervals=intervals)
    assert list(parameter_rows(named, data)) == [
        ("offset_m", "0.00287 ± 0.00010", "95 % profile interval 0.00263 to 0.00311", "m")
    ]
