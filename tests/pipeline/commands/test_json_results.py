"""With `--json`, a command prints one object of its documented schema, and ends with the same exit code."""

import json
import shutil

import jsonschema
import pytest

from pipeline.json_results import RESULTS, result_json_schema


@pytest.fixture
def result(symolo):
    """Runs a command with and without `--json`, and returns the object after the checks that hold for every command."""

    def result(command, *arguments):
        plain = symolo(command, *arguments)
        ended = symolo(command, *arguments, "--json")
        assert ended.code == plain.code
        document = json.loads(ended.out, parse_constant=pytest.fail)
        jsonschema.validate(document, result_json_schema(command))
        assert (document["command"], document["exit_code"]) == (command, ended.code)
        return document

    return result


def described(schema, parts):
    """Whether each key of a schema and of its parts has a meaning."""
    for name, value in schema["properties"].items():
        yield name, bool(value.get("description"))
    for part in parts.values():
        yield from described(part, {})


@pytest.mark.parametrize("command", RESULTS)
def test_the_schema_is_printed_and_describes_every_key(command, symolo):
    ended = symolo("schema", "--of", command)
    schema = json.loads(ended.out)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert [name for name, is_described in described(schema, schema.get("$defs", {})) if not is_described] == []


def test_a_release_without_a_fault(dataset, result):
    document = result("verify", dataset)
    assert (document["faults"], document["reproduced"]) == ([], None)


def test_each_fault_of_a_release(dataset, copy_of, result):
    root = copy_of(dataset)
    (root / "CW/test_1/images/000002.jpg").unlink()
    document = result("verify", root)
    assert document["exit_code"] == 4
    assert [fault["file"] for fault in document["faults"]] == ["CW/test_1/images/000002.jpg"]


def test_what_a_folder_contains_and_what_the_next_release_would_do(dataset, copy_of, result, tiny):
    root = copy_of(dataset, stages=True)
    document = result("status", root, "smoke", *tiny, "--check")
    assert [run["run"] for run in document["runs"]] == ["CW/test_1", "CCW/test_1"]
    assert all(run["done"] for run in document["runs"])
    assert (document["faults"], document["release_finished"], document["next_release"]) == (0, True, {})
    assert document["cost"]["images"] == 12
    (root / "CW/test_1/data.csv").write_text("t\n0\n")
    (root / "README.md").unlink()
    document = result("status", root, "--check")
    assert (document["faults"], document["exit_code"]) == (2, 4)
    assert document["next_release"] == {"release: some of its files were changed": 1}
    (root / "manifest-sha256.txt").unlink()
    shutil.rmtree(root / ".stages/render/CW/test_1")
    document = result("status", root)
    assert document["release_finished"] is False
    assert document["next_release"] == {
        "render: it was never begun": 1,
        "release: it is assembled again after its other stages": 1,
    }


def test_how_alike_two_releases_are(dataset, copy_of, result):
    other = copy_of(dataset)
    assert result("compare", dataset, other)["conclusion"] == "identical"
    (other / "CW/test_1/images/000001.jpg").unlink()
    lines = (other / "CW/test_1/data.csv").read_text().splitlines()
    lines[3] = lines[3].replace("0.55", "0.56", 1)
    (other / "CW/test_1/data.csv").write_text("\n".join(lines) + "\n")
    document = result("compare", dataset, other)
    assert (document["conclusion"], document["exit_code"]) == ("different", 7)
    verdicts = {file["name"]: file["verdict"] for file in document["differences"]}
    assert verdicts == {"CW/test_1/images/000001.jpg": "only_in_a", "CW/test_1/data.csv": "different"}
    level = next(file["level_db"] for file in document["differences"] if file["verdict"] == "different")
    assert 0 < level < 50
    every = result("compare", dataset, other, "--all")
    assert len(every["differences"]) == every["files"]
    assert every["identical"] == every["files"] - 2


def test_what_a_scenario_would_make(result, tiny):
    document = result("plan", "smoke", *tiny)
    assert [(run["run"], run["rows"], run["images"]) for run in document["runs"]] == [
        ("CW/test_1", 21, 6),
        ("CCW/test_1", 21, 6),
    ]
    assert document["images"] == 12
    assert document["bytes"] == sum(run["bytes"] for run in document["runs"])


def test_a_dry_run_of_a_release_states_whether_there_is_anything_to_do(dataset, copy_of, result, symolo, tiny):
    """The exit code is 0 in both cases."""
    root = copy_of(dataset, stages=True)
    release = ("release", "smoke", "--out", root, "--dry-run")
    document = result(*release, *tiny)
    assert (document["up_to_date"], document["would_do"], document["would_fail"]) == (True, {}, [])
    assert document["would_keep"] == ["CW/test_1", "CCW/test_1"]
    document = result(*release, *tiny, "--set", "seed=8")
    assert (document["up_to_date"], document["exit_code"], document["would_keep"]) == (False, 0, [])
    assert max(document["would_do"].values()) == 2
    document = result(*release, *tiny, "--set", "name=other", "--replace")
    assert (document["up_to_date"], document["would_lose"]["runs"]) == (False, ["CCW/test_1", "CW/test_1"])
    refused = symolo(*release, *tiny, "--set", "name=other", "--json")
    assert (refused.code, refused.out) == (2, "")
    for name in ("README.md", "tagmanifest-sha256.txt"):
        (root / name).rename(root.parent / "elsewhere")
        assert result(*release, *tiny)["up_to_date"] is False
        (root.parent / "elsewhere").rename(root / name)
    assert result(*release, *tiny)["up_to_date"] is True
    refused = symolo("release", "smoke", "--out", root, "--json")
    assert (refused.code, refused.out, "--json is for --dry-run; add --dry-run" in refused.err) == (2, "", True)


def test_an_export_and_its_dry_run(dataset, tmp_path, symolo):
    arguments = ("export", dataset, "--format", "tum,hdf5", "--out", tmp_path / "out")
    planned = json.loads(symolo(*arguments, "--dry-run", "--json").out)
    assert not (tmp_path / "out").exists()
    ended = symolo(*arguments, "--json")
    document = json.loads(ended.out)
    jsonschema.validate(document, result_json_schema("export"))
    assert (ended.code, planned["written"], document["written"]) == (0, False, True)
    assert document == {**planned, "written": True}
    for part in document["formats"]:
        files = [path for path in (tmp_path / "out" / part["format"]).rglob("*") if path.is_file()]
        assert (part["files"], part["bytes"]) == (len(files), sum(path.stat().st_size for path in files))


def test_the_errors_of_localisation(dataset, tmp_path, symolo):
    ended = symolo("baselines", dataset, "--methods", "odometry,ekf", "--out", tmp_path / "out", "--json")
    document = json.loads(ended.out)
    jsonschema.validate(document, result_json_schema("baselines"))
    assert (ended.code, document["command"], list(document["methods"])) == (0, "baselines", ["odometry", "ekf"])
    numbers = json.loads((tmp_path / "out/baselines.json").read_text())["runs"]
    assert len(document["errors"]) == sum(map(len, numbers.values())) == 4
    for part in document["errors"]:
        written = numbers[part["run"]][part["method"]]
        assert {name: part[name] for name in written} == pytest.approx(written, abs=1e-6)


def test_the_content_of_a_log(result):
    document = result("inspect", "table-1")
    assert (document["kind"], document["rows"]) == ("motor_steady", 21)
    speed = next(channel for channel in document["channels"] if channel["name"] == "omega_rad_s")
    assert (speed["role"], speed["unit"], speed["min"]) == ("reading", "rad/s", 0.0)


def test_the_checks_of_the_machine(symolo, monkeypatch):
    monkeypatch.setattr("pipeline.doctor._child", lambda _program: (0, "version 4.5.0\n", ""))  # both engines start
    monkeypatch.setattr("pipeline.doctor.locked_versions", lambda: {"scipy": "9.9"})
    ended = symolo("doctor", "--json")
    document = json.loads(ended.out)
    jsonschema.validate(document, result_json_schema("doctor"))
    assert (ended.code, document["exit_code"]) == (5, 5)
    missing = [check for check in document["checks"] if not check["ok"]]
    assert [check["name"] for check in missing] == ["scipy"]
    assert missing[0]["cure"] == "run ./setup in the repository"


def test_what_is_refused_prints_nothing_on_standard_output(tmp_path, symolo):
    for command in ("verify", "status"):
        ended = symolo(command, tmp_path / "none", "--json")
        assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
