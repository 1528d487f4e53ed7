"""Which run or image is in which split: shares, whole groups, and rules that cannot be applied."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from symolo.core.errors import FaultsError, InputError
from symolo.dataset.documents.origin import Origin, ReleaseOrigin
from symolo.dataset.splits import DEFAULT_SHARES, SplitMember, SplitRule, assign

HALVES = {"train": 0.5, "test": 0.5}


def members(routes=("A", "B"), runs=10, **fields):
    defaults = {"look": "lab", "robot": "nominal", "seed": 1}
    return [SplitMember(f"{route}/test_{n}", **defaults | fields) for route in routes for n in range(1, runs + 1)]


def by(grouping, shares=DEFAULT_SHARES, seed=7):
    return SplitRule(grouping, shares, {}, seed)


def sizes(record):
    return {name: len(record.runs[name]) for name in record.names}


@pytest.mark.parametrize(
    ("runs", "shares", "expected"),
    [
        (20, DEFAULT_SHARES, {"train": 14, "validation": 3, "test": 3}),
        (3, DEFAULT_SHARES, {"train": 1, "validation": 1, "test": 1}),
        (10, {"train": 0.8, "test": 0.2}, {"train": 8, "test": 2}),
        (100, {"train": 0.98, "validation": 0.01, "test": 0.01}, {"train": 98, "validation": 1, "test": 1}),
        (5, {"train": 0.98, "validation": 0.01, "test": 0.01}, {"train": 3, "validation": 1, "test": 1}),
        (4, {"train": 1.0}, {"train": 4}),
    ],
)
def test_each_split_has_its_share_of_the_groups_and_at_least_one(runs, shares, expected):
    assert sizes(assign(by("run", shares), members(("A",), runs), "")) == expected


def test_each_run_is_in_one_split_and_the_same_rule_gives_the_same_splits():
    runs = members()
    record = assign(by("run"), runs, "")
    assert Counter(run for ones in record.runs.values() for run in ones) == Counter(run.run for run in runs)
    assert assign(by("run"), list(reversed(runs)), "").split_by_run == record.split_by_run
    assert assign(by("run", seed=8), runs, "").split_by_run != record.split_by_run


def test_over_many_seeds_each_run_is_tested_as_often_as_its_share():
    """The share of test is 0.15 of 20 runs, 3 of 20; 4 standard deviations of a binomial distribution of 400 draws."""
    counts = Counter(run for seed in range(400) for run in assign(by("run", seed=seed), members(), "").runs["test"])
    spread = 4 * (400 * 0.15 * 0.85) ** 0.5
    assert all(abs(counts[run.run] - 60) < spread for run in members())


@pytest.mark.parametrize("grouping", ["route", "look", "robot", "arena", "seed"])
def test_no_group_is_divided(grouping):
    """Runs of three looks, robots and seeds, and of three routes."""
    runs = [
        SplitMember(f"{route}/test_{n}", f"look{group}", f"robot{group}", group, arena=f"{group}" * 64)
        for group, route in enumerate("ABC")
        for n in range(1, 5)
    ]
    record = assign(by(grouping), runs, "")
    assert sizes(record) == {"train": 4, "validation": 4, "test": 4}
    assert all(len({run.partition("/")[0] for run in ones}) == 1 for ones in record.runs.values())


def test_images_of_one_trajectory_under_several_looks_are_in_one_split():
    runs = [
        SplitMember(
            f"CW-{look}/test_{n}",
            look,
            "nominal",
            1,
            Origin(release=ReleaseOrigin(name="symolo", manifest_sha256="0" * 64, run=f"CW/test_{n}")),
        )
        for look in ("lab", "night")
        for n in (1, 2, 3)
    ]
    record = assign(by("run"), runs, "")
    for ones in record.runs.values():
        assert [run.replace("lab", "night") for run in ones if "lab" in run] == [run for run in ones if "night" in run]
    assert sizes(record) == {"train": 2, "validation": 2, "test": 2}


def test_splits_by_image_divide_runs_and_contain_each_image_once():
    runs = members(runs=2, images=range(1, 26))
    record = assign(by("image"), runs, "")
    assert not record.runs
    assert {name: sum(map(len, ones.values())) for name, ones in record.images.items()} == {
        "train": 70,
        "validation": 15,
        "test": 15,
    }
    assert len(record.split_by_image) == 100
    assert all(len(record.images["train"][run.run]) < 25 for run in runs)


def test_listed_runs_are_in_the_split_of_their_pattern():
    rule = SplitRule(None, {}, {"test": ("B/*",), "train": ("A/test_1", "A/test_2")}, 7)
    record = assign(rule, members(runs=2), "")
    assert (record.by, record.names) == ("listed", ("train", "test"))
    assert record.runs == {"train": ("A/test_1", "A/test_2"), "test": ("B/test_1", "B/test_2")}


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (by("look"), "1 group is too few for 3 splits: all runs have the same look (lab)"),
        (by("route"), "2 groups are too few for 3 splits: the groups are A, B: got 'route'"),
        (by("arena"), "1 group is too few for 3 splits: all runs have the same arena: got 'arena'"),
        (by("image"), "0 images for 3 splits; remove shares, or make more images"),
        (SplitRule(None, {}, {"train": ("A/*",)}, 1), "splits.runs: B/test_1, B/test_2 are in no split; add"),
        (
            SplitRule(None, {}, {"train": ("*",), "test": ("B/*",)}, 1),
            "splits.runs: B/test_1, B/test_2 are in train and test",
        ),
        (SplitRule(None, {}, {"train": ("*",), "test": ("C/*",)}, 1), "splits.runs.test: no run matches: got 'C/*'"),
    ],
)
def test_a_rule_that_the_runs_do_not_allow_is_refused(rule, message):
    with pytest.raises(InputError) as error:
        assign(rule, members(runs=2), "my.yaml:3")
    assert str(error.value).startswith("my.yaml:3: ")
    assert message in str(error.value)


def test_all_faults_of_listed_splits_are_reported_together():
    rule = SplitRule(None, {}, {"train": ("A/*", "C/*"), "test": ("A/test_2",)}, 1)
    with pytest.raises(FaultsError) as error:
        assign(rule, members(runs=2), "--splits")
    texts = [str(fault) for fault in error.value.faults]
    assert [text.partition(";")[0].partition(", allowed")[0] for text in texts] == [
        "--splits: splits.runs.train: no run matches: got 'C/*'",
        "--splits: splits.runs: A/test_2 is in train and test",
        "--splits: splits.runs: B/test_1, B/test_2 are in no split",
    ]


def of_looks(counts, route="A"):
    return [
        SplitMember(f"{route}/test_{look}{n}", look, "nominal", 1)
        for look, count in counts.items()
        for n in range(count)
    ]


@pytest.mark.parametrize("seed", range(20))
def test_each_split_has_the_same_mix_of_looks_up_to_one_run(seed):
    """Sizes are those without strata; of each look, a split has its share, rounded down or up."""
    rng = np.random.default_rng(seed)
    looks = {f"look{i}": int(count) for i, count in enumerate(rng.integers(1, 12, 5))}
    runs = of_looks(looks)
    rule = replace(by("run", seed=seed), stratify=("look",))
    record = assign(rule, runs, "")
    assert sizes(record) == sizes(assign(by("run", seed=seed), runs, ""))
    look_of = {run.run: run.look for run in runs}
    for split, ones in record.runs.items():
        got = Counter(look_of[run] for run in ones)
        for look, count in looks.items():
            assert abs(got[look] - count * len(record.runs[split]) / len(runs)) < 1 + 1e-6
    assert assign(rule, list(reversed(runs)), "").split_by_run == record.split_by_run


def test_runs_of_each_look_are_divided_as_the_shares_say():
    """Of 20 runs of each of three looks: 14, 3 and 3. Without strata, another mix is more likely."""
    runs = of_looks({"lab": 20, "night": 20, "sun": 20})
    rules = [replace(by("run", seed=seed), stratify=("look",)) for seed in range(3)]
    for record in (assign(rule, runs, "") for rule in rules):
        for split, count in (("train", 14), ("validation", 3), ("test", 3)):
            names = [run.partition("_")[2].rstrip("0123456789") for run in record.runs[split]]
            assert Counter(names) == {"lab": count, "night": count, "sun": count}
    assert len({tuple(assign(rule, runs, "").runs["test"]) for rule in rules}) == 3


def test_strata_divide_no_group():
    """Four routes, two of them driven by each robot."""
    runs = [
        SplitMember(f"{route}/test_{n}", "lab", robot, 1)
        for route, robot in zip("ABCD", "xxyy", strict=True)
        for n in (1, 2, 3)
    ]
    for seed in range(10):
        record = assign(SplitRule("route", HALVES, {}, seed, ("robot",)), runs, "")
        for ones in record.runs.values():
            assert {run.partition("/")[0] for run in ones} in ({"A", "C"}, {"A", "D"}, {"B", "C"}, {"B", "D"})
    assert record.model_dump(mode="json")["stratify"] == ["robot"]
    assert "stratify" not in assign(by("route", HALVES), runs, "").model_dump(mode="json")
