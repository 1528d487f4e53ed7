"""Drawn values beside what was asked for, and where their marks stand."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from symolo.core.distributions import Choice, LogUniform, Normal, Uniform, in_words
from symolo.reader.dataset import load
from symolo.report.plots.draw_strip import MAX_MARKS, strip
from symolo.report.statistics.draws import DrawnField, drawn_fields
from symolo.report.statistics.run_facts import run_facts

ASKED = (
    "look={extends: classroom, sun: {elevation_deg: {uniform: [20, 40]}}}",
    "look.floor.material={choice: [parquet, linoleum]}",
    "robot.chassis.mass_kg={log_uniform: [0.9, 1.1]}",
)


def draws(root):
    data = load(root)
    records = {record.run: record for record in data.metadata.runs}
    facts = [run_facts(run, records[run.name], with_path=False) for run in data]
    return {draw.field: draw for draw in drawn_fields(facts, data.metadata.scenario)}, data


def test_each_draw_has_the_values_of_the_runs_and_the_distribution_of_the_scenario(painted):
    drawn, data = draws(painted(settings=ASKED))
    specs = [run.specification for run in data]
    assert drawn["look.sun.elevation_deg"].distribution == Uniform(20, 40)
    assert drawn["look.sun.elevation_deg"].values == tuple(spec["look"]["sun"]["elevation_deg"] for spec in specs)
    assert drawn["robot.chassis.mass_kg"].distribution == LogUniform(0.9, 1.1)
    assert drawn["robot.chassis.mass_kg"].numbers == tuple(spec["robot"]["chassis"]["mass_kg"] for spec in specs)
    materials = drawn["look.floor.material"]
    assert (materials.distribution, materials.numbers) == (Choice(("parquet", "linoleum")), None)
    assert sum(count for _, count in materials.counts) == len(specs)
    assert set(drawn) >= set(specs[0]["drawn"]) - {"start.x_m", "start.y_m", "start.yaw_deg"}


def test_what_a_route_asks_for_is_its_own(painted):
    drawn, data = draws(painted(settings=["routes.0.start.x_m={normal: [0.55, 0.003]}"]))
    assert drawn["start.x_m (CW)"].distribution == Normal(0.55, 0.003)
    assert drawn["start.x_m (CW)"].values == tuple(run.spec.start.x_m for run in data if run.name.startswith("CW/"))
    assert "start.x_m (CCW)" not in drawn  # a number there, so that nothing is drawn


def test_what_a_route_asks_of_its_own_arena_is_its_own(painted):
    width = "arena.line.width_m"
    own = "routes.CCW.arena={extends: symolo, line: {width_m: {uniform: [0.03, 0.04]}}}"
    drawn, data = draws(painted(settings=[f"{width}={{uniform: [0.01, 0.02]}}", own]))
    widths = {run.name: run.specification["arena"]["line"]["width_m"] for run in data}
    for field, route, asked in ((width, "CW", Uniform(0.01, 0.02)), (f"{width} (CCW)", "CCW", Uniform(0.03, 0.04))):
        assert drawn[field].distribution == asked
        assert drawn[field].values == tuple(value for name, value in widths.items() if name.startswith(f"{route}/"))


def test_a_run_that_was_rendered_again_belongs_to_the_route_of_its_trajectory(painted):
    data = load(painted())
    release = SimpleNamespace(run="CCW/test_1")
    record = SimpleNamespace(run="CCW-lab_2/test_1", origin=SimpleNamespace(release=release), drawn={})
    facts = replace(run_facts(data.runs[0], data.metadata.runs[0], with_path=False), record=record)
    assert (facts.route, facts.source_route) == ("CCW-lab_2", "CCW")


def test_what_another_version_asked_for_is_left_out_and_its_draws_are_not(painted):
    data = load(painted(settings=ASKED))
    record = data.metadata.runs[0]
    facts = run_facts(data.runs[0], record, with_path=False)
    scenario = {"look": {"sun": {"elevation_deg": {"uniform": [1, 2, 3]}}}}
    (draw,) = [one for one in drawn_fields([facts], scenario) if one.field == "look.sun.elevation_deg"]
    assert (draw.distribution, draw.values) == (None, (record.drawn["look.sun.elevation_deg"],))


def marks(plot):
    return [rectangle for rectangle in plot.rectangles if rectangle.kind == "mark"]


@pytest.mark.parametrize(
    ("asked", "values", "middles"),
    [
        (Uniform(0, 10), (0.0, 5.0, 10.0), (5, 110, 215)),
        (LogUniform(1, 100), (1.0, 10.0, 100.0), (5, 110, 215)),
        (Normal(0, 1), (-1.0, 0.0), (57.5, 110)),  # the axis is from -2 to 2 sd
        (Normal(0, 1), (-2.0, 3.0), (5, 215)),  # and goes on to the last mark
        (None, (4.0,), (110,)),
    ],
)
def test_marks_stand_where_their_values_are_between_the_ends_of_what_was_asked_for(asked, values, middles):
    positions = sorted(mark.x + 0.5 * mark.width for mark in marks(strip(values, asked)))
    assert positions == pytest.approx(sorted(middles), abs=0.06)


def test_many_values_are_a_histogram_whose_bars_are_as_high_as_their_counts():
    values = [0.01] * 90 + [0.99] * 30
    heights = [mark.height for mark in marks(strip(values, Uniform(0, 1)))]
    assert len(values) > MAX_MARKS
    assert len(heights) == 2
    assert heights[0] / heights[1] == pytest.approx(3, rel=0.01)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (Uniform(1, 2), "uniform 1 to 2"),
        (LogUniform(1, 2), "log-uniform 1 to 2"),
        (Normal(0, 0.2, -0.5, 0.5), "normal 0, sd 0.2, cut at -0.5 and 0.5"),
        (Normal(5, 1), "normal 5, sd 1"),
        (Normal(5, 1, low=3), "normal 5, sd 1, cut at 3 and 9"),
        (Normal(5, 1, high=6), "normal 5, sd 1, cut at 1 and 6"),
        (Choice(("a", 2, True)), "choice of a, 2, True"),
        (Choice(tuple(range(10))), "choice of 0, 1, 2, 3, 4, 5, 6, 7 and 2 more"),
        (None, ""),
    ],
)
def test_a_distribution_in_words(asked, words):
    assert in_words(asked) == words


def test_true_and_false_are_no_numbers():
    assert DrawnField("x", (True, False, True), None).numbers is None
    assert DrawnField("x", (True, False, True), None).counts == [("True", 2), ("False", 1)]
