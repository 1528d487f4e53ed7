"""Which runs train a model, what is refused, and the warning about a model that is judged by its own runs."""

from dataclasses import replace

import pytest

from pipeline.baselines import odometry
from pipeline.baselines.compare import compare
from pipeline.baselines.learned.method import overlap
from pipeline.baselines.learned.model import run_fingerprint
from pipeline.baselines.learned.training_runs import check_trainable
from pipeline.baselines.output import numbers, table
from pipeline.baselines.runs import open_runs
from symolo.core.errors import InputError
from symolo.core.progress import LineReport


@pytest.fixture(scope="module")
def runs(dataset):
    """Two runs of one arena."""
    return open_runs(dataset)


def of_runs(model, training, validation=("f" * 16,)):
    about = model.about.model_copy(update={"training_runs": tuple(training), "validation_runs": tuple(validation)})
    return replace(model, about=about)


def test_runs_without_images_are_refused_with_the_remedy(runs):
    with pytest.raises(InputError, match=r"CW/test_1: .*release the scenario, with rates\.camera_hz above 0"):
        check_trainable([replace(run, images=None) for run in runs])


def test_a_run_has_one_fingerprint_in_every_copy_and_no_other_run_has_it(runs):
    one, other = (run_fingerprint(run.spec) for run in runs)
    assert one != other
    assert run_fingerprint(runs[0].spec.model_copy(deep=True)) == one
    assert run_fingerprint(runs[0].spec.model_copy(update={"seed": runs[0].spec.seed + 1})) != one


def test_a_model_that_is_judged_by_its_own_runs_draws_a_warning(model, runs):
    one, other = (run_fingerprint(run.spec) for run in runs)
    assert not overlap(of_runs(model, ["0" * 16]), runs)
    assert overlap(of_runs(model, [one]), runs).startswith("1 of these 2 runs trained the model")
    assert overlap(of_runs(model, ["0" * 16], [other]), runs).startswith("1 of these 2 runs")
    assert overlap(of_runs(model, [one], [other]), runs).startswith("2 of these 2 runs")


def test_the_table_and_the_numbers_have_the_warning(runs):
    compared = compare([odometry.METHOD], runs, runs, start_sd=[0.001] * 3, seed=1, report=LineReport())
    assert "Warning" not in table(compared)
    assert b"warning" not in numbers(compared)
    warned = replace(compared, warnings=("2 of these 2 runs trained the model",))
    assert "**Warning:** 2 of these 2 runs trained the model." in table(warned)
    assert b"2 of these 2 runs trained the model" in numbers(warned)
