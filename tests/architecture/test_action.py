"""The GitHub action: the shell of its steps runs here as on a runner, and the command lines that it types work."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
WORKFLOW = yaml.safe_load((ROOT / ".github/workflows/smoke.yml").read_text())
STEPS = {step.get("name", step.get("uses")): step for step in ACTION["runs"]["steps"]}
RECORDER = """#!/bin/bash
printf '%s\\0' "$@" >>typed; echo >>typed
if [[ -f answer ]]; then cat answer; exit "$(cat code)"; fi
"""
"""A program that writes down how it was called, and prints the answer that the test has prepared."""


class Runner:
    """A runner in a folder: what one step writes for the next ones is there for them."""

    def __init__(self, folder, inputs, programs):
        self.folder = folder
        self.inputs = {name: one.get("default", "") for name, one in ACTION["inputs"].items()} | inputs
        self.outputs = {}
        self.path = f"{programs}:{Path(sys.executable).parent}:{os.environ['PATH']}"
        for name in ("output", "summary"):
            (folder / name).touch()

    def value(self, expression):
        """The value of an expression of the action, such as `${{ inputs.out }}`."""
        if match := re.fullmatch(r"\$\{\{ inputs\.([\w-]+) \}\}", expression):
            return self.inputs[match.group(1)]
        (name,) = re.fullmatch(r"\$\{\{ steps\.compare\.outputs\.(\w+) \}\}", expression).groups()
        return self.outputs.get(name, "")

    def do(self, name):
        step = STEPS[name]
        variables = {key: self.value(expression) for key, expression in step.get("env", {}).items()}
        runner = {"GITHUB_OUTPUT": "output", "GITHUB_STEP_SUMMARY": "summary", "RUNNER_TEMP": "."}
        runner = {key: str(self.folder / place) for key, place in runner.items()}
        environment = {**os.environ, "PATH": self.path, "GITHUB_ACTION_PATH": str(ROOT), **runner, **variables}
        shell = ["bash", "--noprofile", "--norc", "-e", "-o", "pipefail", "-c", step["run"]]
        ended = subprocess.run(shell, cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
        self.outputs |= dict(line.split("=", 1) for line in (self.folder / "output").read_text().splitlines())
        return ended

    def typed(self):
        """The arguments of each call since the last question."""
        typed = self.folder / "typed"
        lines = typed.read_text().splitlines()
        typed.unlink()
        return [line.split("\0")[:-1] for line in lines]

    def answer(self, ended):
        """Let the next calls end as one did."""
        (self.folder / "answer").write_text(ended.out)
        (self.folder / "code").write_text(str(ended.code))


@pytest.fixture
def runner(tmp_path, dataset, tiny, monkeypatch):
    """A folder in which the release of the tests has been made, and its stages are still there."""
    shutil.copytree(dataset, tmp_path / "symolo-dataset")
    monkeypatch.chdir(tmp_path)
    recorder = tmp_path / "programs/symolo"
    recorder.parent.mkdir()
    recorder.write_text(RECORDER)
    recorder.chmod(0o755)
    settings = "\n".join(option.removeprefix("--set=") for option in tiny)

    def runner(programs=recorder.parent, **inputs):
        named = {name.replace("_", "-"): value for name, value in inputs.items()}
        return Runner(tmp_path, {"settings": f"{settings}\n"} | named, programs)

    return runner


def test_the_command_lines_that_it_types_make_verify_and_compare(runner, dataset, symolo):
    run = runner(reference=str(dataset))
    assert run.do("Make the release").returncode == 0
    release, verify = run.typed()
    assert (release[0], verify[0]) == ("release", "verify")
    assert symolo(*release).code == 0
    assert symolo(*verify).code == 0
    run.do("Compare it with the stored one")
    (compare,) = run.typed()
    ended = symolo(*compare)
    assert ended.code == 0
    assert (run.folder / "symolo-differences.html").is_file()
    run.answer(ended)
    assert run.do("Compare it with the stored one").returncode == 0
    assert run.outputs == {"conclusion": "identical"}
    assert (run.folder / "summary").read_text().startswith("symolo: identical: ")


@pytest.mark.parametrize(
    ("allow", "conclusion", "code"),
    [("close", "identical", 0), ("close", "close", 0), ("close", "different", 1), ("identical", "close", 1)],
)
def test_the_job_fails_at_its_end_if_more_differs_than_is_allowed(runner, allow, conclusion, code):
    run = runner(reference="reference", allow=allow)
    run.outputs["conclusion"] = conclusion
    decided = run.do("Decide")
    assert (decided.returncode, "symolo-differences.html" in decided.stdout) == (code, code == 1)


def test_a_comparison_that_cannot_be_made_ends_the_step_and_one_that_differs_does_not(runner, dataset, symolo):
    run = runner(reference="none")
    run.do("Compare it with the stored one")
    (compare,) = run.typed()
    run.answer(symolo(*compare))
    assert run.do("Compare it with the stored one").returncode == 2
    (run.folder / "symolo-dataset/CW/test_1/images/000001.jpg").unlink()
    compare[compare.index("none")] = str(dataset)
    run.answer(symolo(*compare))
    assert run.do("Compare it with the stored one").returncode == 0
    assert run.outputs == {"conclusion": "different"}


def test_a_likeness_that_does_not_exist_is_refused_before_the_release(runner):
    run = runner(allow="some")
    assert run.do("Make the release").returncode == 2
    assert not (run.folder / "typed").exists()


@pytest.mark.documents
def test_all_steps_with_the_installed_command(runner, dataset):
    run = runner(programs="", reference=str(dataset), allow="identical")
    for name in ("Make the release", "Compare it with the stored one", "Decide"):
        assert run.do(name).returncode == 0, name


def test_every_expression_and_condition_names_something_that_is_there():
    text = (ROOT / "action.yml").read_text()
    assert set(re.findall(r"inputs\.([\w-]+)", text)) == set(ACTION["inputs"])
    assert set(re.findall(r"steps\.(\w+)\.outputs", text)) == {step["id"] for step in STEPS.values() if "id" in step}
    assert STEPS["Keep release and page"]["if"].startswith("always()"), "the page is kept if the comparison fails"


def test_no_input_is_pasted_into_a_shell():
    for step in STEPS.values():
        assert "${{" not in step.get("run", "")


def test_the_workflow_calls_it_with_its_inputs_and_files_that_are_there():
    (call,) = (step for step in WORKFLOW["jobs"]["smoke"]["steps"] if step["uses"] == "./")
    assert set(call["with"]) <= set(ACTION["inputs"])
    assert (ROOT / call["with"]["scenario"]).is_file()
    assert (ROOT / call["with"]["reference"] / "metadata.json").is_file()
