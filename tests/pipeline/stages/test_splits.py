"""Splits of a scenario in its release: they can be added later, and change neither runs nor images."""

import json

from symolo.dataset.documents.splits_record import SplitsRecord
from symolo.verification.verify import verify


def test_splits_are_added_to_a_release_without_rendering_again(dataset, copy_of, symolo, tiny):
    root = copy_of(dataset, stages=True)
    before = {path: path.stat().st_mtime_ns for path in root.glob("*/*/images/*.jpg")}
    rule = "--set=splits={by: route, shares: {train: 0.5, test: 0.5}}"
    assert symolo("release", "smoke", "--out", root, *tiny, rule, "--workers", 1).code == 0
    assert {path: path.stat().st_mtime_ns for path in root.glob("*/*/images/*.jpg")} == before
    metadata = json.loads((root / "metadata.json").read_text())
    splits = metadata.pop("splits")
    assert metadata.pop("scenario")["splits"] == {"by": "route", "shares": {"train": 0.5, "test": 0.5}}
    assert {*splits["runs"]["train"], *splits["runs"]["test"]} == {"CW/test_1", "CCW/test_1"}
    assert (splits["by"], splits["seed"]) == ("route", metadata["seed"])
    without = json.loads((dataset / "metadata.json").read_text())
    assert "splits" not in without
    assert metadata == {key: value for key, value in without.items() if key != "scenario"}
    assert "## Splits\n\nDivided by route.\n" in (text := (root / "README.md").read_text())
    for split, (run,) in splits["runs"].items():
        assert f"\n| {split} | 1 | 6 | {run} |\n" in text
    assert "## Splits" not in (dataset / "README.md").read_text()
    assert not list(verify(root))


def test_a_sentence_names_the_grouping_and_what_is_mixed():
    record = SplitsRecord(by="run", seed=1, stratify=("route", "look"), runs={"train": ("A/test_1",)})
    assert record.how == "Divided by run, with about the same mix of route and look in each split."
    assert SplitsRecord(by="listed", seed=1, runs={"train": ()}).how == "The runs of each split were listed."


def test_a_run_that_failed_leaves_the_splits_of_the_others():
    record = SplitsRecord(by="run", seed=1, runs={"train": ("A/test_1", "A/test_2"), "test": ("A/test_3",)})
    assert record.only({"A/test_1", "A/test_3"}).runs == {"train": ("A/test_1",), "test": ("A/test_3",)}
    assert record.only({"A/test_1"}).runs == {"train": ("A/test_1",), "test": ()}
    assert (record.empty, record.only({"A/test_1"}).empty) == ((), ("test",))


def drawn(*widths_mm: int) -> list[str]:
    """Return the settings of four runs without images whose line has one of these widths."""
    widths = ", ".join(f"{0.001 * width:g}" for width in widths_mm)
    routes = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 4}]"
    rule = "splits={by: arena, shares: {train: 0.5, test: 0.5}}"
    settings = (
        f"arena.line.width_m={{choice: [{widths}]}}",
        routes,
        rule,
        "rates.camera_hz=0",
        "stop.time_limit_s=0.2",
    )
    return [f"--set={setting}" for setting in settings]


def test_runs_in_the_same_drawn_arena_are_in_one_split(tmp_path, symolo):
    out = tmp_path / "data"
    assert symolo("release", "smoke", "--out", out, *drawn(15, 19), "--workers", 1).code == 0
    runs = json.loads((out / "metadata.json").read_text())["splits"]["runs"]
    specs = {run: json.loads((out / run / "side/spec.json").read_text()) for ones in runs.values() for run in ones}
    widths = {name: {specs[run]["arena"]["line"]["width_m"] for run in ones} for name, ones in runs.items()}
    assert widths in ({"train": {0.015}, "test": {0.019}}, {"train": {0.019}, "test": {0.015}})
    exported = symolo("export", out, "--format", "parquet", "--splits", drawn(15)[2][13:], "--out", tmp_path / "out")
    assert exported.code == 0
    assert json.loads((tmp_path / "out/export.json").read_text())["splits"]["runs"] == runs


def test_routes_with_arenas_of_their_own_are_divided_by_arena(tmp_path, symolo):
    out, start = tmp_path / "data", "start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}"
    routes = f"routes=[{{name: A, {start}, runs: 2}}, {{name: B, arena: moving, {start}}}]"
    settings = (
        routes,
        "splits={by: arena, shares: {train: 0.5, test: 0.5}}",
        "rates.camera_hz=0",
        "stop.time_limit_s=0.2",
    )
    assert symolo("release", "smoke", "--out", out, *(f"--set={each}" for each in settings), "--workers", 1).code == 0
    runs = json.loads((out / "metadata.json").read_text())["splits"]["runs"]
    assert {frozenset(ones) for ones in runs.values()} == {frozenset({"A/test_1", "A/test_2"}), frozenset({"B/test_1"})}
    assert "Routes have arenas of their own" in (out / "README.md").read_text()
    assert not list(verify(out))


def test_too_few_drawn_arenas_are_refused_before_anything_is_simulated(tmp_path, symolo):
    ended = symolo("release", "smoke", "--out", tmp_path / "data", *drawn(15, 15))
    assert ended.code == 2
    assert "1 group is too few for 2 splits: all runs have the same arena: got 'arena'" in ended.err
    assert not (tmp_path / "data").exists()
