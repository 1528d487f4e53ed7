"""Duty cycles without a sign, and the columns that state in which sense the motors turn."""

import numpy as np
import pytest

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.proposal import propose
from diagnosis.new_case.quantities import KINDS
from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.mapping import LogMapping, check_mapping
from symolo.core.errors import InputError

T = 0.05 * np.arange(240)
DUTY = {"l": np.where(T % 4 < 3, 100, -60), "r": np.where(T % 5 < 3.5, 120, -90)}
"""Duty cycles with a sign; 255 is a full one."""


def rows(texts, *, prefix="dir", counts=None, duty=DUTY):
    """Return a log whose wheels turn by 1 tick for each step of the duty cycle, with a direction in words."""
    header = ["t_s", "enc_l", "enc_r", "pwm_l", f"{prefix}_l", "pwm_r", f"{prefix}_r"]
    columns = [np.round(T, 3)]
    columns += [np.concatenate([[0], np.cumsum(duty[side])[:-1]]) for side in "lr"] if counts is None else counts
    for side in "lr":
        columns += [np.abs(duty[side]), np.where(duty[side] < 0, texts[1], texts[0])]
    lines = [",".join(header), *(",".join(map(str, row)) for row in zip(*columns, strict=True))]
    return "\n".join(lines) + "\n"


def read(tmp_path, text):
    path = tmp_path / "run.csv"
    path.write_text(text)
    return read_log(path)


@pytest.mark.parametrize(
    "texts", [("F", "B"), ("forward", "reverse"), ("1", "-1"), ("1", "0"), ("0", "1"), ("1", "2"), ("cw", "ccw")]
)
def test_a_duty_cycle_gets_the_sign_of_its_direction(tmp_path, texts):
    log = read(tmp_path, rows(texts))
    proposal = propose(log, supply_V=10.2)
    drive = measurement_of(log, proposal.mapping, "run")
    for name, side in (("u_left_V", "l"), ("u_right_V", "r")):
        np.testing.assert_allclose(drive.trials[0][name].values, 10.2 / 255 * DUTY[side], atol=1e-9)
    assert any(
        f"pwm_l (u_left_V): without a sign; it is taken for negative where dir_l is {texts[1]}" in note
        for note in proposal.warnings
    )


def test_a_counter_that_counts_backwards_shows_the_same_direction_as_the_wheel(tmp_path):
    """A counter of 16 bits that wraps counts the turns of a wheel all the same."""
    counts = [np.concatenate([[0], np.cumsum(DUTY[side])[:-1]]) % 65536 for side in "lr"]
    log = read(tmp_path, rows(("1", "0"), counts=counts))
    assert propose(log).mapping.columns["u_right_V"].backwards == (0.0,)


def test_ticks_since_the_row_before_show_the_direction_of_a_duty_cycle_without_a_sign(tmp_path):
    duty = {side: np.round(150.0 * np.sin(speed * T)).astype(int) for side, speed in (("l", 1.1), ("r", 1.7))}
    log = read(tmp_path, rows(("1", "0"), duty=duty, counts=[duty["l"], duty["r"]]))
    columns = propose(log).mapping.columns
    assert columns["enc_left_ticks"].per_row
    assert columns["u_left_V"].backwards == (0.0,)


@pytest.mark.parametrize("texts", [("F", "B"), ("1", "-1"), ("1", "0")])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_duty_cycle_stays_without_a_sign_beside_counts_without_one(tmp_path, texts, sense):
    """A sensor with one channel counts up whatever the sense, so that both are sizes."""
    counts = [sense * np.concatenate([[0], np.cumsum(np.abs(DUTY[side]))[:-1]]) for side in "lr"]
    log = read(tmp_path, rows(texts, counts=counts))
    proposal = propose(log, supply_V=10.2)
    voltage = measurement_of(log, proposal.mapping, "run").trials[0]["u_left_V"]
    if sense > 0:
        np.testing.assert_allclose(voltage.values, 10.2 / 255 * np.abs(DUTY["l"]), atol=1e-9)
        assert [note for note in proposal.warnings if note.startswith("pwm_l (u_left_V): without a sign")]
    assert len(set(np.sign(voltage.values))) == 1


def test_the_speed_of_a_bench_without_a_sign_leaves_the_voltage_without_one(tmp_path):
    lines = [f"{0.01 * k:.2f},3,{10 + k % 3},0.1,{'B' if k > 100 else 'F'}" for k in range(200)]
    log = read(tmp_path, "\n".join(["t_s,u_cmd_V,omega_rad_s,current_A,direction", *lines]) + "\n")
    proposal = propose(log)
    assert not proposal.mapping.columns["u_cmd_V"].direction
    sentence = "u_cmd_V (u_cmd_V): without a sign, as is omega_rad_s; direction, which would give it one, is not used"
    assert sentence in proposal.warnings


def test_a_duty_cycle_with_a_sign_keeps_it(tmp_path):
    text = rows(("1", "0")).replace(",100,1,", ",-100,1,")
    assert not propose(read(tmp_path, text)).mapping.columns["u_left_V"].direction


def test_a_direction_that_neither_words_nor_wheels_show_is_asked_for(tmp_path):
    duty = {side: np.where(T % 4 < 2, 100, -100) for side in "lr"}
    toggling = rows(("1", "0"), duty=duty).splitlines()
    cells = [line.split(",") for line in toggling]
    for k, row in enumerate(cells[1:]):
        row[4] = str(k % 2)
    text = "\n".join(map(",".join, cells)) + "\n"
    with pytest.raises(InputError, match=r"column dir_l: .*\n?.*backwards: \[VALUE\]"):
        propose(read(tmp_path, text))


def test_a_mapping_states_the_direction_by_words_or_numbers(tmp_path):
    log = read(tmp_path, rows(("hin", "her")))
    columns = {
        "t_s": {"column": "t_s"},
        "enc_left_ticks": {"column": "enc_l"},
        "enc_right_ticks": {"column": "enc_r"},
        "u_left_V": {"column": "pwm_l", "factor": 0.04, "direction": "dir_l", "backwards": ["her"]},
        "u_right_V": {"column": "pwm_r", "factor": 0.04, "direction": "dir_r", "backwards": ["her"]},
    }
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    drive = measurement_of(log, mapping, "run")
    np.testing.assert_allclose(drive.trials[0]["u_left_V"].values, 0.04 * DUTY["l"], atol=1e-9)
    del columns["u_left_V"]["direction"]
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    with pytest.raises(InputError, match="backwards without direction"):
        check_mapping(mapping, KINDS[CaseKind.DRIVE_LOG], log, "mapping.yaml")


def test_a_missing_direction_is_marked(init):
    """The wheels turn backwards at duty cycles that are never below zero."""
    t = 0.05 * np.arange(400)
    duty = {side: np.where((t + shift) % 6 < 4, 100, -80) for side, shift in (("l", 0.0), ("r", 1.0))}
    columns = {"t_s": np.round(t, 3)}
    for side in "lr":
        columns[f"enc_{side}"] = np.concatenate([[0], np.cumsum(duty[side] // 2)[:-1]])
        columns[f"pwm_{side}"] = np.abs(duty[side])
    numbers = [f"--set={key}" for key in ("ticks_per_turn=1440", "wheel_diameter_m=0.065", "track_m=0.14")]
    back = np.count_nonzero(duty["l"] < 0)
    sign = f"CHECK u_left_V is never below 0, but the left wheel turns backwards in {back} rows that have a voltage"
    assert sign in init(columns, "--out", "unsigned", *numbers)[1]
    columns["pwm_l"], columns["pwm_r"] = duty["l"], duty["r"]
    assert "CHECK" not in init(columns, "--out", "signed", *numbers)[1]
