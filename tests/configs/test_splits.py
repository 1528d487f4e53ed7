"""`splits` of a scenario: what is refused before anything is simulated, and what a scenario without it contains."""

import pytest

from configs.loader import load_scenario
from symolo.core.errors import InputError


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("splits.by=look", "all runs have the same look (classroom): got 'look'"),
        ("splits.by=route", "splits.by: 2 groups are too few for 3 splits: the groups are CCW, CW"),
        ("splits={by: run, shares: {train: 0.5, test: 0.6}}", "splits.shares: got 'train 0.5, test 0.6: in all 1.1'"),
        ("splits={by: run, shares: {train: 1, test: 0}}", "splits.shares.test: got 0, allowed: number > 0 and <= 1"),
        ("splits={}", "got 'neither by nor runs', allowed: one of by and runs"),
        ("splits={by: run, runs: {train: ['*']}}", "got 'by and runs', allowed: one of by and runs"),
        (
            "splits={runs: {train: ['*']}, seed: 3}",
            "got 'runs with shares or seed', allowed: shares, seed and stratify only with",
        ),
        ("splits={by: route, stratify: [route]}", "got 'route with by: route', allowed: other properties than by"),
        ("splits={by: image, stratify: [look]}", "splits.stratify: got 'look with by: image'"),
        ("splits={by: run, stratify: [seed]}", "splits.stratify"),
        ("splits={runs: {}}", "splits.runs: got 'no split', allowed: runs of train, validation, test"),
        ("splits={runs: {train: [CW/*], test: [CWW/*]}}", "splits.runs.test: no run matches: got 'CWW/*'"),
        ("splits={runs: {train: [CW/*]}}", "splits.runs: CCW/test_1, CCW/test_2, CCW/test_3 are in no split"),
        ("splits={by: {choice: [run, route]}}", "no distribution is allowed here"),
    ],
)
def test_splits_that_cannot_be_made_are_refused(setting, message):
    with pytest.raises(InputError) as error:
        load_scenario("symolo", [setting])
    assert message in str(error.value)
    assert "--set splits" in str(error.value)


@pytest.mark.parametrize(
    "setting", ["splits.by=run", "splits.by=image", "splits={runs: {train: [CW/*], test: [CCW/*]}}"]
)
def test_splits_stand_in_the_resolved_scenario_as_written(setting):
    assert "splits" not in load_scenario("symolo").tree
    splits = load_scenario("symolo", [setting]).tree["splits"]
    assert splits in ({"by": "run"}, {"by": "image"}, {"runs": {"train": ["CW/*"], "test": ["CCW/*"]}})
