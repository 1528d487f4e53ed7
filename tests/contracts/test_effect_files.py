"""A scenario names the file of an own effect: its text is kept with the data, and no dataset's code is executed."""

import hashlib
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_run
from configs.effects.registry import EFFECTS
from configs.loader import load_resolved, load_scenario
from configs.schema.scenario import RunSpec
from configs.validation.json_schema import scenario_json_schema
from pipeline.cli import main
from pipeline.code_files import code_file_lines, named_contents
from pipeline.run_folder.changes import changes
from pipeline.run_folder.stored_spec import spec_problem
from pipeline.stages.simulate import simulate
from symolo.core.errors import InputError
from symolo.core.field_descriptions import field_descriptions

EFFECT = """
from typing import Annotated

from configs.effects.base import Effect, Slot
from configs.effects.parameter import Parameter


class LeakyShunt(Effect):
    slot = Slot.CURRENT_READING
    cause = "flux that was left on the board beside the shunt"
    excitation = "large currents"

    share: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=0.5)]

    def apply(self, current_A):
        return (1.0 - self.share) * current_A
"""
ROBOT = """
extends: nominal
name: leaky
description: a robot with an effect of its own
effect_files: [code/leaky_shunt.py]
effects: {leaky_shunt: {share: 0.05}}
"""
SCENARIO = """
extends: smoke
robot: robots/leaky.yaml
routes: [{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}]
stop: {lap: false, time_limit_s: 0.5}
"""


def forget():
    """Forget the files that were loaded, as a new process would."""
    for file in [*EFFECTS.files.values()]:
        EFFECTS.unload(file.path)


@pytest.fixture
def scenario(tmp_path):
    (tmp_path / "robots/code").mkdir(parents=True)
    (tmp_path / "robots/code/leaky_shunt.py").write_text(EFFECT)
    (tmp_path / "robots/leaky.yaml").write_text(ROBOT)
    path = tmp_path / "mine.yaml"
    path.write_text(SCENARIO)
    yield path
    forget()


def drawn(scenario, *settings):
    return draw_run(load_scenario(str(scenario), settings), "CW", 1)


def test_the_robot_file_names_it_relative_to_itself_and_the_specification_has_its_text(scenario, monkeypatch, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    robot = json.loads(drawn(scenario).model_dump_json())["robot"]
    assert robot["effects"] == {"leaky_shunt": {"share": 0.05}}
    sha256 = hashlib.sha256(EFFECT.encode()).hexdigest()
    assert robot["effect_files"] == [
        {"name": "leaky_shunt", "file": "leaky_shunt.py", "sha256": sha256, "text": EFFECT}
    ]


def test_a_run_has_the_effect(scenario):
    bare = simulate(drawn(scenario, "robot=nominal")).recording["current_A"].values
    leaky = simulate(drawn(scenario)).recording["current_A"].values
    np.testing.assert_allclose(leaky, 0.95 * bare)
    assert np.abs(bare).max() > 0.01


def test_a_robot_without_the_effect_has_no_record(scenario):
    assert drawn(scenario, "robot.effects.leaky_shunt=null").robot.effect_files == ()
    assert drawn(scenario, "robot=nominal").robot.effect_files == ()


def test_a_file_of_the_command_line_is_recorded_as_well(scenario, tmp_path):
    by_robot = drawn(scenario)
    forget()
    EFFECTS.load(tmp_path / "robots/code/leaky_shunt.py")
    by_option = drawn(scenario, "robot=nominal", "robot.effects.leaky_shunt.share=0.05")
    assert by_option.robot.effect_files == by_robot.robot.effect_files


def test_a_setting_names_it_relative_to_the_working_folder(scenario, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path / "robots")
    settings = ("robot=nominal", "robot.effect_files=[code/leaky_shunt.py]", "robot.effects.leaky_shunt.share=0.1")
    assert [file.name for file in drawn(scenario, *settings).robot.effect_files] == ["leaky_shunt"]


def test_a_robot_that_extends_another_has_the_files_of_both(scenario, tmp_path):
    (tmp_path / "robots/other.py").write_text(EFFECT.replace("LeakyShunt", "OtherShunt"))
    (tmp_path / "robots/both.yaml").write_text(
        "extends: leaky.yaml\nname: both\neffect_files: [other.py]\neffects: {other_shunt: {share: 0.1}}\n"
    )
    spec = drawn(scenario, f"robot={tmp_path}/robots/both.yaml")
    assert [file.name for file in spec.robot.effect_files] == ["leaky_shunt", "other_shunt"]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ("[code/leaky.py]", r"leaky\.yaml:5: robot\.effect_files: no such file: got "),
        ("code/leaky_shunt.py", r"robot\.effect_files: got 'code/leaky_shunt\.py', allowed: a list of Python files"),
        ("[3]", r"robot\.effect_files: got 3, allowed: a list of Python files"),
        ("[{name: leaky_shunt, sha256: a, text: b}]", "effect_files: got .*allowed: a list .*write it to a file"),
        ("[{name: a}]", r"robot\.effect_files: got .*, allowed: a list of Python files"),
        ("[]", r"robot\.effects\.leaky_shunt: unknown key"),
    ],
)
def test_a_wrong_name_is_refused_with_its_place(scenario, tmp_path, files, message):
    (tmp_path / "robots/leaky.yaml").write_text(ROBOT.replace("[code/leaky_shunt.py]", files))
    with pytest.raises(InputError, match=message):
        drawn(scenario)


def test_an_edited_file_is_loaded_again_and_is_a_change_of_the_run(scenario, tmp_path):
    before = drawn(scenario)
    (tmp_path / "robots/code/leaky_shunt.py").write_text(EFFECT.replace("1.0 - self", "1.0 + self"))
    after = drawn(scenario)
    assert after.robot.effects.members[0].apply(1.0) == pytest.approx(1.05)
    (change,) = changes(before, after, simulation=True)
    assert re.fullmatch(r"robot\.effect_files\.0\.sha256 [0-9a-f]{12} -> [0-9a-f]{12}", change)


class TestWithoutTheFile:
    """What a stranger's specification does, whose code nobody has agreed to."""

    @pytest.fixture
    def text(self, scenario):
        text = drawn(scenario).model_dump_json()
        forget()
        return text

    def test_it_is_read_and_written_back_equal(self, text):
        spec = RunSpec.model_validate_json(text)
        assert json.loads(spec.model_dump_json()) == json.loads(text)
        assert spec_problem(text) == ""
        assert EFFECTS.files == {}

    def test_it_is_not_simulated(self, text):
        spec = RunSpec.model_validate_json(text)
        with pytest.raises(
            InputError, match=r"effect leaky_shunt: its file leaky_shunt\.py .*not loaded; .*--effect-file"
        ):
            simulate(spec)

    def test_it_is_simulated_with_the_same_file_and_no_other(self, text, tmp_path):
        path = tmp_path / "copy.py"
        path.write_text(EFFECT)
        EFFECTS.load(path)
        assert RunSpec.model_validate_json(text).robot.effects.members[0].share == 0.05
        path.write_text(EFFECT + "# another\n")
        EFFECTS.load(path)
        with pytest.raises(InputError, match=r"the file has changed since the data were made: got .*, allowed: "):
            simulate(RunSpec.model_validate_json(text))

    def test_a_text_that_does_not_fit_its_hash_is_a_fault(self, text):
        assert "effect_files.0.text" in spec_problem(text.replace("1.0 - self", "1.0 + self"))

    @pytest.mark.parametrize(
        "files",
        [
            3, "a.py", ["a.py"], [3], [None], [{}], [{"name": ["leaky_shunt"]}], [{"name": "leaky_shunt"}],
            [{"name": "leaky_shunt", "file": "../a.py", "sha256": "0" * 64, "text": ""}],
        ],
    )  # fmt: skip
    def test_a_damaged_record_is_a_fault_and_no_error_of_the_reader(self, text, files):
        content = json.loads(text)
        content["robot"]["effect_files"] = files
        assert spec_problem(json.dumps(content)) != ""

    @pytest.mark.parametrize("name", ["../a.py", "..", ".a.py", "a/b.py", "a\\b.py", "a.sh", "a\n.py", ""])
    def test_a_name_that_leads_elsewhere_is_a_fault(self, text, name):
        content = json.loads(text)
        content["robot"]["effect_files"][0]["file"] = name
        assert spec_problem(json.dumps(content)).startswith("robot.effect_files.0.file")

    def test_no_run_is_drawn_from_its_scenario(self, scenario):
        tree = load_scenario(str(scenario)).tree
        forget()
        with pytest.raises(InputError, match=r"effect leaky_shunt: its file .* is not loaded"):
            load_resolved(tree, "metadata.json")


def test_the_files_of_simulated_runs_are_listed_and_extracted_without_loading_them(scenario, tmp_path, capsys):
    run = tmp_path / "data/.stages/simulate/CW/test_1"
    run.mkdir(parents=True)
    (run / "trajectory.npz").touch()
    (run / "spec.json").write_text(drawn(scenario).model_dump_json())
    forget()
    (line,) = code_file_lines(tmp_path / "data")
    assert line.startswith("effect leaky_shunt: made with leaky_shunt.py, SHA-256 ")
    assert line.endswith("not loaded; only --effect-file leaky_shunt.py simulates its runs again")
    assert main(["effect", "extract", str(tmp_path / "data"), "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out/leaky_shunt.py").read_text() == EFFECT
    assert EFFECTS.files == {}
    EFFECTS.load(tmp_path / "out/leaky_shunt.py")
    assert [line] != [*code_file_lines(tmp_path / "data")] == [line.partition("; ")[0] + "; " + SAME]
    (run / "spec.json").write_text(drawn("smoke").model_dump_json())
    assert [*code_file_lines(tmp_path / "data")] == []
    assert main(["effect", "extract", str(tmp_path / "data"), "--out", str(tmp_path / "none")]) == 2
    assert "contains no file of effects of a user's own" in capsys.readouterr().err


def test_two_files_of_one_name_are_both_written(scenario, tmp_path):
    (first,) = drawn(scenario).robot.effect_files
    (tmp_path / "robots/code/leaky_shunt.py").write_text(EFFECT + "# another\n")
    (second,) = drawn(scenario).robot.effect_files
    assert named_contents([first, second]) == {
        "leaky_shunt.py": EFFECT.encode(),
        f"leaky_shunt-{second.sha256[:8]}.py": EFFECT.encode() + b"# another\n",
    }


SAME = "a file with the same content is loaded"


@pytest.mark.long
def test_a_release_is_repaired_only_with_the_file(scenario, tmp_path, tiny, capsys):
    out, code = tmp_path / "data", tmp_path / "robots/code/leaky_shunt.py"
    assert main(["release", str(scenario), "--out", str(out), *tiny, "--workers", "1"]) == 0
    forget()
    wheels = out / "CW/test_1/side/wheels.csv"
    released = wheels.read_bytes()
    shutil.rmtree(out / ".stages")
    wheels.unlink()
    assert main(["repair", str(out)]) == 4
    assert "effect leaky_shunt: its file leaky_shunt.py" in capsys.readouterr().out
    assert main(["effect", "extract", str(out), "--out", str(tmp_path / "extracted")]) == 0
    extracted = tmp_path / "extracted/leaky_shunt.py"
    assert extracted.read_bytes() == code.read_bytes()
    assert EFFECTS.files == {}
    assert main(["--effect-file", str(extracted), "repair", str(out)]) == 0
    assert wheels.read_bytes() == released
    forget()
    capsys.readouterr()
    assert main(["verify", str(out)]) == 0
    assert "effect leaky_shunt: made with leaky_shunt.py, SHA-256 " in capsys.readouterr().out
    code.write_text(EFFECT + "# another\n")
    assert main(["--effect-file", str(code), "status", str(out)]) == 0
    assert f"the loaded file {code} has changed since" in capsys.readouterr().out


def test_the_schema_for_editors_takes_a_list_of_paths():
    definitions = scenario_json_schema()["$defs"]
    assert definitions["RobotConfig"]["properties"]["effect_files"]["items"]["type"] == "string"


def _law(name, lines, meaning):
    """Return the text of an effect whose class begins after some lines."""
    return (
        "\n" * lines
        + f'''from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from symolo.core.arrays import Array


class {name}(Effect):
    """A law of a test."""

    slot = Slot.CURRENT_READING
    cause = "a test"
    excitation = "any voltage"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    more_A: Annotated[float, Parameter("A", null=0.0, start=0.01, low=-0.1, high=0.1)]
    """{meaning}"""

    def apply(self, current_A: Array) -> Array:
        return current_A + self.more_A
'''
    )


def test_texts_of_one_file_name_that_are_executed_in_turn_have_their_own_descriptions():
    """Although Python remembers the lines of a file that it saw first."""
    for name, lines, meaning in (("Short", 0, "Of one."), ("Longer", 30, "Of another."), ("Short", 0, "Of one.")):
        effect = EFFECTS.executed(Path("law.py"), _law(name, lines, meaning).encode())
        assert field_descriptions(effect) == {"more_A": meaning}
