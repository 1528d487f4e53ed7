"""The disk space of a plan: one copy is the dataset, and `.stages` has another one with the jobs."""

import json

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.planning.plan import ScenarioPlan


@pytest.mark.parametrize("annotations", ["[]", "[depth]"])
def test_the_stages_have_a_copy_of_the_dataset_and_a_job_for_each_rendering(annotations):
    """A row takes 600 bytes, an image 4096 and 0.2 for each pixel, its annotations 0.6 more, and a job 0.5 MB."""
    plan = ScenarioPlan.from_specs(draw_all(load_scenario("smoke", [f"render.annotations={annotations}"])), 1)
    per_pixel, jobs = (0.8, 2) if annotations != "[]" else (0.2, 1)
    images, rows = plan.images, sum(run.rows for run in plan.runs)
    assert plan.dataset_bytes == pytest.approx(600 * rows + images * (4096 + 160 * 120 * per_pixel), rel=1e-6)
    assert plan.bytes_needed == pytest.approx(2 * plan.dataset_bytes + 2 * jobs * 0.5e6, rel=1e-6)


def test_a_plan_states_the_size_of_the_dataset_and_that_of_the_stages(symolo):
    result = json.loads(symolo("plan", "smoke", "--json").out)
    data, whole = (round(result[name] / 1e6) for name in ("dataset_bytes", "bytes"))
    assert f"disk       about {whole} MB: {data} MB of data, the rest in .stages" in symolo("plan", "smoke").out


def test_fewer_workers_simulate_fewer_runs_at_a_time_and_share_all_cores_when_they_render():
    """Two runs of 6 s on 8 cores: at a time two, or one; 3 workers have 2 of 8 threads each, and 2 cores rest."""
    specs = draw_all(load_scenario("smoke"))
    all_cores, two, three, one = (ScenarioPlan.from_specs(specs, 8, workers=workers) for workers in (None, 2, 3, 1))
    assert two.simulation_s == all_cores.simulation_s == pytest.approx(0.5 * one.simulation_s)
    assert one.render_s == two.render_s == all_cores.render_s == pytest.approx(6 / 8 * three.render_s)
    assert ScenarioPlan.from_specs(specs, 8, workers=64).render_s == all_cores.render_s
    assert "Assumed: 1 worker on 8 cores without" in one.text()
    assert "Assumed: 8 cores without" in all_cores.text()


def test_plan_takes_the_workers_of_a_release(symolo):
    assert "Assumed: 3 workers on " in symolo("plan", "smoke", "--workers", 3).out
    ended = symolo("plan", "smoke", "--workers", 3, "--images", 50)
    assert (ended.code, "--workers: got 3; leave it out" in ended.err) == (2, True)
