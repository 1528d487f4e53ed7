import pickle

import pytest

from symolo.core.errors import FaultList, InputError, nearest, one_line, shown, together


def test_the_parts_of_an_error_stand_in_one_order():
    error = InputError("robot.x_m", where="a.yaml:3", got="abc", allowed="number", nearest="0.1", cure="write it")
    assert str(error) == "a.yaml:3: robot.x_m: got 'abc', allowed: number; did you mean 0.1; write it"


def test_parts_that_are_not_given_leave_no_trace():
    assert str(InputError("out/ is not empty")) == "out/ is not empty"
    assert str(InputError("--workers", got=0, allowed="1 or more")) == "--workers: got 0, allowed: 1 or more"
    assert str(InputError("key", where="a.yaml:1", allowed="text")) == "a.yaml:1: key; allowed: text"


def test_an_error_comes_out_of_a_worker_process_unchanged():
    error = InputError("robot.x_m", where="a.yaml:3", got=None)
    assert str(pickle.loads(pickle.dumps(error))) == "a.yaml:3: robot.x_m: got nothing (null)"  # noqa: S301 - our own bytes
    several = together([InputError("a"), InputError("b")])
    assert str(pickle.loads(pickle.dumps(several))) == str(several)  # noqa: S301 - our own bytes


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "true"),
        (3.5, "3.5"),
        ("a\nb", r"'a\nb'"),
        ([1, "a"], "[1, 'a']"),
        ([1, 2, 3, 4, 5], "[1, 2, 3, 4, ...]"),
        ({"a": {"b": None}}, "{a: {b: nothing (null)}}"),
        ("x" * 100, "'" + "x" * 60 + "'..."),
        ("\n" * 100, "'" + r"\n" * 30 + "'..."),
        ("a" * 59 + "\n" * 10, "'" + "a" * 59 + "'..."),
    ],
)
def test_values_are_shown_short_and_as_the_user_writes_them(value: object, text: str):
    assert shown(value).startswith(text)
    assert len(shown(value)) <= 65


def test_nearest_looks_past_case_and_gives_up_on_strangers():
    names = ["winding_resistance_ohm", "torque_constant_N_m_A"]
    assert nearest("WINDING_RESISTENCE_OHM", names) == "winding_resistance_ohm"
    assert nearest("elevation_deg", names) == ""
    assert nearest(None, names) == ""


@pytest.mark.parametrize(("name", "result"), [("val", "validation"), ("VALID", "validation"), ("va", ""), ("tra", "")])
def test_an_abbreviation_is_the_beginning_of_one_name_alone(name, result):
    assert nearest(name, ["training", "trajectory", "validation"]) == result


def test_characters_that_turn_the_direction_of_a_line_are_left_out():
    marks = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
    assert one_line(f"gnp{marks}.exe") == "gnp .exe"
    assert str(InputError("name", got=f"a{marks}b")).isprintable()


def test_several_faults_are_listed_and_of_very_many_the_first():
    faults = FaultList()
    with faults.noted():
        raise InputError("a", where="x.yaml:1")
    with faults.noted():
        raise together([InputError("b"), InputError("c")])
    assert str(together(faults.faults)) == "3 faults:\n  x.yaml:1: a\n  b\n  c"
    assert isinstance(together(faults.faults[:1]), InputError)
    lines = str(together([InputError(f"{i}") for i in range(1000)])).splitlines()
    assert (len(lines), lines[0], lines[-1]) == (22, "1000 faults:", "  and 980 more")


def test_no_fault_is_no_error_and_one_fault_is_itself():
    faults = FaultList()
    faults.check()
    with faults.noted():
        raise InputError("a")
    with pytest.raises(InputError, match=r"^a$"):
        faults.check()


def test_a_long_list_of_what_is_allowed_is_shortened():
    """As the names of the columns of a log, which a stranger may have made as long as he likes."""
    assert len(str(InputError("column", allowed="a" * 10_000, cure="look"))) < 2000
