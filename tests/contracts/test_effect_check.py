"""`symolo effect check` finds what is wrong with an effect in a file, and `symolo effect new` writes a good one."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from configs.effects.arguments import ARGUMENTS, takes_arguments
from configs.effects.registry import EFFECTS
from pipeline.cli import main
from pipeline.effects.check import load_to_fit
from pipeline.effects.contract import RULES, judged
from pipeline.effects.probe import Probe
from pipeline.effects.template import template
from pipeline.effects.template_laws import LAWS
from pipeline.effects.trial import trials
from sensors.effects.range_sensor.range_offset import RangeOffset
from symolo.core.errors import InputError

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/oval_wheel.py"
GOOD = '''
"""A shunt that takes less of a large current."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter


class BentShunt(Effect):
    slot = Slot.CURRENT_READING
    cause = "a magnetic core that saturates"
    excitation = "small and large currents"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    bend_per_A: Annotated[float, Parameter("1/A", null=0.0, start=0.1, low=0.0, high=0.5)]
    """reading = I / (1 + bend |I|)."""

    def apply(self, current_A):
        return current_A / (1.0 + self.bend_per_A * np.abs(current_A))
'''
RETURN = "return current_A / (1.0 + self.bend_per_A * np.abs(current_A))"
REFUSING = """
    @__import__("pydantic").field_validator("bend_per_A", check_fields=False)
    @classmethod
    def _is_small(cls, value):
        if value > 0.4:
            raise ValueError("too large")
        return value

"""
SILENT = """    more_A: Annotated[float, Parameter("A", null=None, start=1.0, low=0.0, high=9.0)]

"""
PER_STEP = '''
"""Slip that grows with the turn of one step in the place of the speed."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter


class TurnedSlip(Effect):
    slot = Slot.ROLLING
    cause = "wheels that slip more the faster they turn"
    excitation = "several speeds of the wheels"
    setups = (Setup.DRIVE,)

    slip_per_rad: Annotated[float, Parameter("1/rad", null=0.0, start=0.2, low=-1.0, high=1.0)]
    """share * (1 - slip |turn|)."""

    def apply(self, share, angle_rad, turned_rad):
        return share * (1.0 - self.slip_per_rad * np.abs(turned_rad))
'''
BROKEN = [
    ("texts", ('"a magnetic core that saturates"', '"core"'), "cause is 'core': write a text of more than"),
    ("texts", ("(Setup.MOTOR_BENCH, Setup.DRIVE)", "Setup.DRIVE"), "setups is .*: write a tuple of some of"),
    ("bounds", ("start=0.1", "start=0.7"), r"bend_per_A: low=0, start=0\.7, high=0\.5: needs"),
    ("bounds", ("start=0.1", "start=0.0"), "needs -100000 < low < start"),
    ("bounds", ("null=0.0", "null=0.9"), r"null=0\.9 is outside"),
    ("bounds", ("null=0.0", "null=0.1"), "the start is the null value, at which nothing shows"),
    ("units", ('"1/A"', '"m/s"'), "bend_per_A: the unit is 'm/s', so the name ends in _m_per_s or _m_s"),
    ("units", ('"1/A"', '" "'), "bend_per_A: no unit"),
    ("settings", ("    cause =", REFUSING + "    cause ="), r"bend_per_A: 0\.5 is refused, within its bounds"),
    ("form", (RETURN, "pass"), "apply returns NoneType, and its first argument is ndarray"),
    ("form", (RETURN, "return current_A[..., 0]"), "apply fails in line 22: IndexError|of shape"),
    ("form", (RETURN, "return current_A if current_A > 1 else self.bend_per_A"), "apply fails in line 22: ValueError"),
    ("form", (RETURN, "raise SystemExit(3)"), "line 22: SystemExit: 3"),
    ("null", (RETURN, "return current_A * (1.0 + 1e-15)"), "at the null values the reading .*current_A changes by"),
    ("start", (RETURN, "return current_A + 0.0 * self.bend_per_A"), "at the start values no reading changes"),
    ("pure", (RETURN, "current_A *= 0.9\n        return current_A"), "changes an array that it was given"),
    ("pure", (RETURN, "return current_A * np.random.default_rng().random()"), "no random numbers, no memory"),
    ("repeats", (RETURN, "return current_A * np.random.default_rng().random()"), "gives other readings when it is"),
    ("finite", (RETURN, "return current_A / (0.5 - self.bend_per_A)"), r"bend_per_A=0\.5 gives a result that is not"),
    ("rows", (RETURN, "return current_A - current_A.mean() * self.bend_per_A"), "one row alone gives another result"),
    ("stacks", (RETURN, "return current_A * (1.0 - np.max(self.bend_per_A))"), "several robots at once, with arrays"),
    ("acts", ("    def apply", SILENT + "    def apply"), "more_A: no value changes a reading"),
    ("steps", (GOOD, PER_STEP), "its effect on the path differs by 50 %: apply uses the size of a turn or a duration"),
    ("distinct", (RETURN, "return current_A * (1.0 - self.bend_per_A)"), "current_sensor_gain has the same effect on"),
    ("distinct", (RETURN, "return current_A + 3.0 * self.bend_per_A"), "current_sensor_offset has the same effect on"),
]  # fmt: skip
PROBE = Probe()


@pytest.fixture
def written(tmp_path):
    """Write and load files with effects, and forget them afterwards."""
    loaded = []

    def write(text, name="bent_shunt.py"):
        path = tmp_path / name
        path.write_text(text)
        loaded.append(path)
        return EFFECTS.load(path)

    yield write
    for path in loaded:
        EFFECTS.unload(path)


def problems(effect, *rules):
    chosen = [rule for rule in RULES if not rules or rule.name in rules]
    return [f"{v.rule.name}: {v.problem}" for t in trials(effect, PROBE) for v in judged(t, chosen) if v.problem]


def test_the_good_one_keeps_every_rule(written):
    assert problems(written(GOOD)) == []


def test_an_inverse_unit_may_be_spelled_as_in_the_names_of_the_settings(written):
    """A setting of the controller is `face_gain_1_s`."""
    assert problems(written(GOOD.replace("bend_per_A", "bend_1_A")), "units") == []


@pytest.mark.parametrize(("rule", "change", "message"), BROKEN)
def test_a_broken_rule_is_named_with_its_reason(written, rule, change, message):
    assert GOOD.count(change[0]) == 1
    (problem,) = problems(written(GOOD.replace(*change)), rule)
    assert re.search(f"^{rule}: .*(?:{message})", problem), problem


def test_every_rule_has_an_effect_that_breaks_it():
    assert {rule.name for rule in RULES} == {rule for rule, _, _ in BROKEN}


def test_the_command_explains_every_rule_and_names_the_most_similar_effect(capsys):
    assert main(["effect", "check", str(EXAMPLE)]) == 0
    EFFECTS.unload(EXAMPLE)
    printed = capsys.readouterr().out
    for rule in RULES:
        assert re.search(rf"^  ok +{rule.name} +{re.escape(rule.meaning)}$", printed, re.MULTILINE)
    assert "simulate smoke --set robot.effects.oval_wheel.amplitude=0.03 --out data" in printed


def test_a_function_that_fails_is_reported_with_its_line_and_as_no_rule_of_form(tmp_path, capsys):
    path = tmp_path / "bent_shunt.py"
    path.write_text(GOOD.replace(RETURN, "return current_A * npp.exp(self.bend_per_A)"))
    assert main(["effect", "check", str(path)]) == 2
    EFFECTS.unload(path)
    text = "apply fails in line 22: NameError: name 'npp' is not defined"
    assert f"  FAILED runs      apply runs without an error\n         {text}\n" in capsys.readouterr().out
    with pytest.raises(InputError, match=rf"effect bent_shunt: {text}; `symolo effect check"):
        load_to_fit(path)
    EFFECTS.unload(path)


def test_a_broken_rule_ends_with_exit_code_2(tmp_path, capsys):
    path = tmp_path / "bent_shunt.py"
    path.write_text(GOOD.replace(RETURN, "return current_A * (1.0 - self.bend_per_A)"))
    assert main(["effect", "check", str(path)]) == 2
    EFFECTS.unload(path)
    seen = capsys.readouterr()
    assert re.search(r"^  FAILED distinct .*\n +current_sensor_gain has the same effect", seen.out, re.MULTILINE)
    assert seen.err.count("\n") == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("def apply(self", "def apply(self:"), r"bent_shunt\.py:21: effect file: SyntaxError"),
        (("Setup.MOTOR_BENCH", "Setup.MOTOR_BENHC"),
         r"AttributeError: MOTOR_BENHC; allowed: Setup\.MOTOR_BENCH, .*LINE_LOG; did you mean Setup\.MOTOR_BENCH$"),
        (("import numpy as np", "import nmpy as np"), r"bent_shunt\.py:6: effect file: ModuleNotFoundError"),
        (("Slot.CURRENT_READING", '"range"'), r"bent_shunt\.py:12: effect bent_shunt: slot: got 'range', allowed"),
        (("    slot = Slot.CURRENT_READING\n", ""), r"bent_shunt\.py:12: effect bent_shunt: slot missing"),
        (("class BentShunt", "class SupplySag"), r"bent_shunt\.py:12: effect supply_sag: the name is taken"),
        (("\nclass Bent", "\nclass One(Effect):\n    pass\n\n\nclass Bent"), "got 'One, BentShunt', allowed: one"),
        (('Annotated[float, Parameter("1/A", null=0.0, start=0.1, low=0.0, high=0.5)]', "float = 0.1"),
         r"bent_shunt\.py:12: effect bent_shunt: bend_per_A is no parameter; write bend_per_A: Annotated"),
        (("self, current_A", "self, current_A, view"),
         r"effect bent_shunt: arguments of apply: got '\(self, current_A, view\)', allowed: \(self, current_A\) in"),
        (("Slot.CURRENT_READING", "Slot.CREEP"),
         r"got '\(self, current_A\)', allowed: \(self, creep_m, rolled_m, middle_m\) in Slot\.CREEP"),
        ((", high=0.5", ""), r"bent_shunt\.py:18: effect file: TypeError: .*high"),
        (("import numpy as np", "import sys; sys.exit()"), r"bent_shunt\.py:6: effect file: SystemExit"),
        (("import numpy as np", "\0"), r"bent_shunt\.py: effect file: \w+: .*null bytes"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_loaded_has_one_line_with_its_place(tmp_path, capsys, change, message):
    path = tmp_path / "bent_shunt.py"
    path.write_text(GOOD.replace(*change))
    assert main(["effect", "check", str(path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(message, error), error


QUICK = ("current reading", "range", "rolling")


@pytest.mark.parametrize(
    "slot", [slot if slot in QUICK else pytest.param(slot, marks=pytest.mark.long) for slot in LAWS]
)
def test_a_new_file_keeps_every_rule(written, slot):
    name = f"new_{slot.name.lower()}"
    assert problems(written(template(name, slot), f"{name}.py")) == []


def test_new_writes_a_file_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["effect", "new", "oval_wheel", "--slot", "rolling"]) == 0
    assert "class OvalWheel(Effect)" in (tmp_path / "oval_wheel.py").read_text()
    assert main(["effect", "new", "oval_wheel", "--slot", "rolling"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["effect", "new", "bent_reading"]) == 0
    assert "Slot.RANGE " in (tmp_path / "bent_reading.py").read_text()
    said = capsys.readouterr().out
    assert "in the slot 'range', because --slot was not given; others are: actuator, battery, " in said
    assert "`symolo effect list` shows" in said
    for words, message in [
        (["oval_wheel", "--slot", "rollin", "--out", "a.py"], "did you mean rolling"),
        (
            ["oval_wheel", "--slot", "command-delay", "--out", "a.py"],
            "physics/effects/driver_and_battery/input_delay.py",
        ),
        (["supply_sag", "--out", "a.py"], "a shipped effect has this name"),
        (["Oval-Wheel", "--out", "a.py"], "small letters and digits"),
    ]:
        assert main(["effect", "new", *words]) == 2
        assert message in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bent_reading.py", "oval_wheel.py"]


def test_list_and_show_say_what_the_classes_say(capsys):
    assert main(["effect", "list", "--slot", "range noise"]) == 0
    *effects, next_step = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in effects] == ["noise_scale", "ambient_noise"]
    assert "symolo effect show NAME" in next_step
    assert main(["effect", "show", "supply_sag"]) == 0
    shown = capsys.readouterr().out
    assert "meaning:     The supply has an internal resistance" in shown
    assert "source_resistance_ohm: 0 ... 20 ohm, null 0, start 0.5" in shown
    assert main(["effect", "show", "suply_sag"]) == 2
    assert "did you mean supply_sag" in capsys.readouterr().err


def test_the_check_prints_nothing_of_the_engine_that_it_loads():
    program = f"import sys; from pipeline.cli import main; sys.exit(main(['effect', 'check', {str(EXAMPLE)!r}]))"
    ended = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert "keeps every rule" in ended.stdout
    assert not ended.stderr


@pytest.mark.parametrize("slot", list(LAWS))
def test_a_new_file_takes_the_arguments_that_its_slot_lists(slot):
    assert len(LAWS[slot].arguments.split(", ")) == len(ARGUMENTS[slot].split(", "))


def test_an_effect_with_a_wrong_number_of_arguments_is_refused_before_a_drive(tmp_path, capsys):
    path = tmp_path / "bent_shunt.py"
    path.write_text(GOOD.replace("Slot.CURRENT_READING", "Slot.CREEP").replace("self, current_A", "self, a, b"))
    words = ["simulate", "smoke", "--set", "robot.effects.bent_shunt.bend_per_A=0.1", "--out", str(tmp_path / "out")]
    assert main(["--effect-file", str(path), *words]) == 2
    assert "got '(self, a, b)', allowed: (self, creep_m, rolled_m, middle_m)" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("apply", "fits"), [(lambda reading_m, view: reading_m + view, True), (lambda reading_m: reading_m, False)]
)
def test_a_static_apply_has_the_arguments_of_the_slot_without_self(apply, fits):
    effect = type("Shifted", (RangeOffset,), {"__module__": __name__, "apply": staticmethod(apply)})
    assert takes_arguments(effect) == fits
