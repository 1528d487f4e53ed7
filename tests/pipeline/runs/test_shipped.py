"""Every shipped scenario, and every shipped robot and look in one, is planned and driven for a tenth of a second."""

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.references import shipped_names
from pipeline.planning.plan import ScenarioPlan
from pipeline.stages.simulate import simulate

SHORT = ("stop.lap=false", "stop.time_limit_s=0.1")
ROWS = 3  # at 0, 0.05 and 0.1 s

CASES = [(name, ()) for name in shipped_names("scenario")]
CASES += [("smoke", (f"robot={name}",)) for name in shipped_names("robot")]
CASES += [("smoke", (f"look={name}",)) for name in shipped_names("look")]


@pytest.mark.parametrize(("scenario", "overrides"), CASES, ids=lambda value: "-".join(value) if value else "as-it-is")
def test_it_is_planned_and_runs(scenario, overrides):
    specs = draw_all(load_scenario(scenario, (*overrides, *SHORT)))
    assert f"{specs[0].route}/test_1" in ScenarioPlan.from_specs(specs, 1).text()
    for route in {spec.route for spec in specs}:
        outcome = simulate(next(spec for spec in specs if spec.route == route))
        assert not outcome.problems
        assert len(outcome.recording.trajectory.t_s) == ROWS


def test_every_arena_is_that_of_a_shipped_scenario():
    """An arena asks for a start of its own, so that it runs in the scenario made for it."""
    driven = {load_scenario(name).tree["arena"]["name"] for name in shipped_names("scenario")}
    assert driven == set(shipped_names("arena"))
