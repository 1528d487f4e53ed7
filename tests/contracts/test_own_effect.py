"""An effect in a file of the user's own is all that an effect of the project is."""

import importlib.util
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from configs.checks.robot import robot_faults
from configs.draw import draw_run
from configs.effects.registry import EFFECTS
from configs.loader import load_scenario
from configs.schema.scenario import Scenario
from configs.validation.json_schema import scenario_json_schema
from configs.validation.shapes import FullNames, Shape
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.selection.candidates import candidates
from diagnosis.measured.measurement import CaseKind
from pipeline.stages.simulate import simulate
from symolo.core.errors import InputError

ROOT = Path(__file__).parents[2]
TOY = '''
"""A shunt that part of the current goes around."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter


class LeakyShunt(Effect):
    slot = Slot.CURRENT_READING
    cause = "flux that was left on the board beside the shunt"
    excitation = "large currents"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    share: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=0.5)]
    """reading = (1 - share) * current."""

    def apply(self, current_A):
        return (1.0 - self.share) * current_A
'''
SETTING = "robot.effects.leaky_shunt.share"


@pytest.fixture
def toy(tmp_path):
    path = tmp_path / "leaky_shunt.py"
    path.write_text(TOY)
    yield EFFECTS.load(path)
    EFFECTS.unload(path)


def drawn(*settings):
    return draw_run(load_scenario("smoke", ["stop.time_limit_s=0.5", *settings]), "CW", 1)


def test_it_is_unknown_before_it_is_loaded_and_after_it_is_unloaded(tmp_path):
    path = tmp_path / "leaky_shunt.py"
    path.write_text(TOY)
    for _ in range(2):
        with pytest.raises(InputError, match=r"robot\.effects\.leaky_shunt: unknown key"):
            drawn(f"{SETTING}=0.05")
        EFFECTS.load(path)
        assert drawn(f"{SETTING}=0.05").robot.effects.members[0].share == 0.05
        EFFECTS.unload(path)


def test_it_is_a_key_of_the_schema_with_its_bounds(toy):
    schema = scenario_json_schema()["$defs"]
    assert schema["RobotEffects"]["properties"]["leaky_shunt"]["anyOf"][0] == {"$ref": "#/$defs/LeakyShunt"}
    number, _ = schema["LeakyShunt"]["properties"]["share"]["anyOf"]
    assert number == {"type": "number", "minimum": 0.0, "maximum": 0.5}
    with pytest.raises(InputError, match=r"share: got 0\.6, allowed: number >= 0\.0 and <= 0\.5"):
        drawn(f"{SETTING}=0.6")
    with pytest.raises(InputError, match="did you mean leaky_shunt"):
        drawn("robot.effects.leaky_shnt.share=0.1")
    assert toy.name == "leaky_shunt"


def test_it_is_all_that_its_loading_changes_in_the_shape_of_a_scenario(toy):
    """By the schema that pydantic makes of all models at once."""
    whole = Scenario.model_json_schema(schema_generator=FullNames)
    shape = Shape.from_model(Scenario)
    assert whole.pop("$defs") == shape.definitions
    assert whole == shape.schema
    assert any(toy.__name__ in name for name in shape.definitions)


@pytest.mark.usefixtures("toy")
def test_it_is_an_axis_of_randomisation():
    spec = drawn(f"{SETTING}={{uniform: [0.1, 0.2]}}")
    assert 0.1 <= spec.drawn[SETTING] == spec.robot.effects.members[0].share <= 0.2


@pytest.mark.usefixtures("toy")
def test_it_changes_a_run_and_stands_in_the_specification_that_metadata_come_from():
    spec = drawn(f"{SETTING}=0.05")
    bare, changed = (simulate(run).recording for run in (drawn(), spec))
    np.testing.assert_array_equal(changed["wheel_speed_rad_s"].values, bare["wheel_speed_rad_s"].values)
    np.testing.assert_allclose(changed["current_A"].values, 0.95 * bare["current_A"].values)
    assert np.abs(bare["current_A"].values).max() > 0.01
    assert json.loads(spec.model_dump_json())["robot"]["effects"] == {"leaky_shunt": {"share": 0.05}}
    assert load_scenario("smoke", [f"{SETTING}=0.05"]).tree["robot"]["effects"] == {"leaky_shunt": {"share": 0.05}}
    assert type(spec).model_validate_json(spec.model_dump_json()) == spec


@pytest.mark.parametrize(("kind", "is_listed"), [(CaseKind.MOTOR_STEP, True), (CaseKind.TOF_BENCH, False)])
def test_the_diagnosis_tries_it_where_it_can_show(toy, kind, is_listed):
    seen = []

    def predicted(robots):
        seen.extend(robots)
        mean = np.array([[sum(e.share for e in robot.effects if isinstance(e, toy))] for robot in robots])
        return SimpleNamespace(mean=mean, sd=np.ones_like(mean))

    evidence = SimpleNamespace(
        predicted=predicted,
        sd=np.array([1.0]),
        fit=np.array([True]),
        observed=(SimpleNamespace(unit="A"),),
        counts=[1],
        readings=np.array([1.0]),
    )
    listed = candidates(SimpleNamespace(kind=kind, trials=(), cases=()), evidence, Hypothesis(drawn().robot, ()))
    assert ("leaky_shunt" in [effect.name for effect in listed.testable]) is is_listed
    assert any(robot.effects.get(toy) for robot in seen) is is_listed


def test_it_is_a_row_of_the_documentation(toy, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "generate"))
    spec = importlib.util.spec_from_file_location("generated_effects", ROOT / "docs" / "generate" / "effects.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules.pop("markdown", None)
    page = module.effects()
    assert "## leaky_shunt\n" in page
    assert f"{toy.cause[1:]}. Seen in: {toy.excitation}." in page
    assert "| share | 1 | 0 | 0.1 | 0 ... 0.5 |" in page


def test_it_acts_last_in_its_slot_and_has_no_faults_of_its_own(toy):
    assert EFFECTS.classes()[-1] is toy
    robot = drawn("robot.effects.current_sensor_offset.offset_A=0.01", f"{SETTING}=0.05").robot
    assert [effect.name for effect in robot.effects] == ["current_sensor_offset", "leaky_shunt"]
    assert list(robot_faults(robot, in_simulation=True)) == []


def test_loading_a_file_twice_changes_nothing(toy):
    file = sys.modules[toy.__module__].__file__
    assert EFFECTS.load(file) is toy
    assert EFFECTS.classes().count(toy) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("class LeakyShunt", "class CurrentSensorOffset"),
            "effect current_sensor_offset: the name is taken.*another name",
        ),
        (("slot = Slot.CURRENT_READING", "pass"), r"effect leaky_shunt: slot missing.*slot = Slot"),
        (
            ("slot = Slot.CURRENT_READING", 'slot = "range"'),
            r"effect leaky_shunt: slot: got 'range', allowed: Slot\.MOTORS",
        ),
        (("def apply", "def applied"), "effect leaky_shunt: apply missing.*define apply"),
        (("null=0.0", "null=None"), "effect leaky_shunt: no parameter has a null value.*annotate a field"),
        (("class LeakyShunt(Effect)", "class LeakyShunt"), "got 'none', allowed: one class that derives from Effect"),
        (("def apply(self", "def apply(self:"), r"leaky_shunt\.py:19: effect file: SyntaxError"),
        (("(Effect)", "(Effekt)"), r"leaky_shunt\.py:10: effect file: NameError: name 'Effekt'"),
    ],
)
def test_a_file_that_is_not_complete_is_refused_with_its_place_and_a_cure(tmp_path, change, message):
    path = tmp_path / "leaky_shunt.py"
    path.write_text(TOY.replace(*change))
    with pytest.raises(InputError, match=message):
        EFFECTS.load(path)
    assert "leaky_shunt" not in EFFECTS.by_name()


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"effect file: no such file: got .*allowed: a Python file"):
        EFFECTS.load(tmp_path / "nothing.py")
