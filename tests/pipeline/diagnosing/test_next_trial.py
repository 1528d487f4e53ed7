"""`symolo next`: the trial that distinguishes two explanations, its files, and what is refused."""

import json
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.examples.example import FOLDER as EXAMPLES
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.next_trial.design import design_trial
from diagnosis.next_trial.limits import limits_of
from diagnosis.next_trial.remaining import remaining_models
from diagnosis.next_trial.text import trial_text
from pipeline.diagnosing.made_from import MADE_FROM
from symolo.core.errors import InputError

COULOMB = "coulomb_friction_scale"
ASYMMETRY = "friction_asymmetry"


@pytest.fixture(scope="module")
def forward_only(motor_bench_case, tmp_path_factory):
    """A bench whose motor has 1.6 times the dry friction, or that much in this direction only: nobody reversed it."""
    root = tmp_path_factory.mktemp("forward")
    folder = motor_bench_case(root / "bench", sweeps=1)
    noise = np.random.default_rng(11)
    lines = ["row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s"]
    for row in range(21):
        volts, resistance, constant, viscous, coulomb = 0.25 * row, 3.0, 0.3, 0.002, 0.032
        speed = max(constant * volts / resistance - coulomb, 0.0) / (constant**2 / resistance + viscous)
        current = (volts - constant * speed) / resistance + 0.001 * noise.standard_normal()
        speed += 0.04 * noise.standard_normal() * (speed > 0.0)
        split = "holdout" if row % 4 == 3 else "fit"
        lines.append(f"{row + 1},1,{split},{3.0 * row},{volts},{current:.6f},{speed:.5f}")
    (folder / "data.csv").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="module")
def diagnosis(forward_only):
    return diagnose(read_measurement(forward_only, IMPORTERS))


def record(case, folder):
    folder.mkdir()
    (folder / MADE_FROM).write_text(json.dumps({"cases": [str(case)]}))
    return folder


def test_reversing_distinguishes_a_friction_of_one_direction_from_more_friction(symolo, forward_only, tmp_path):
    """Forward, Tc (1 - a) and s Tc are one number; in reverse they are (1 + a) Tc and s Tc."""
    made = record(forward_only, tmp_path / "diagnosis")
    ended = symolo("next", made, "--rows", 6, "--row-seconds", 1, "--out", tmp_path / "next")
    assert ended.code == 0
    for words in (
        "bench is diagnosed again",
        "2 explanations of the old data left",
        "different rows: each explanation",
    ):
        assert words in ended.err
    out = tmp_path / "next"
    expected = json.loads((out / "expected.json").read_text())
    assert {model["name"] for model in expected["models"]} == {COULOMB, ASYMMETRY}
    assert expected["one_right"] > 0.95
    rows = (out / "trial_1" / "data.csv").read_text().splitlines()
    assert len(rows) == 7
    assert all(row.endswith(",,") for row in rows[1:])
    voltage_V = [float(row.split(",")[4]) for row in rows[1:]]
    assert min(voltage_V) < 0.0
    assert max(map(abs, voltage_V)) <= 5.0
    header = (out / "voltages.h").read_text()
    assert all(f"{{1000, {round(1000.0 * volts)}}}" in header for volts in voltage_V)
    assert ended.out.startswith((out / "trial.md").read_text().rstrip("\n"))
    assert f"{out / 'trial_1'} --together" in ended.out


def test_linear_algebra_of_the_command_uses_one_thread():
    """OpenBLAS reads the environment when NumPy loads it, so that the command must set it before."""
    program = (
        "import os, sys\n"
        "from pipeline.cli import main\n"
        "class AtNumPy:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'numpy':\n"
        "            print(os.environ.get('OPENBLAS_NUM_THREADS'))\n"
        "            sys.stdout.flush()\n"
        "            os._exit(0)\n"
        "sys.meta_path.insert(0, AtNumPy())\n"
        "main(['next', '--out', 'nowhere', '.'])\n"
    )
    environment = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")}
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment, check=False
    )
    assert ended.stdout.split() == ["1"], ended.stderr


def test_what_hinders_most_is_named_where_no_trial_distinguishes_two_effects(diagnosis):
    limits = limits_of(diagnosis.measurement, rows=6, row_s=1.0, one_direction=True)
    design = design_trial(diagnosis, limits)
    smallest = design.expected.smallest
    assert smallest is not None
    assert smallest.separation == pytest.approx(0.0, abs=0.05)
    assert design.hindrances[0].text == "both directions"
    text = " ".join(trial_text(design, "symolo diagnose", "", "trial_1").split())
    assert "Both directions would be enough" in text
    assert "If one of them is the cause, expect that others remain beside it" in text
    assert "it alone remains" not in text


def test_two_effects_remain_only_if_they_explain_the_rows_that_were_held_out(diagnosis):
    """They are compared as in the diagnosis, which counts all rows, and not by the rows to which they were fitted."""
    fitted_well = tuple(replace(pair, cost=pair.cost - 1000.0) for pair in diagnosis.selection.pairs)
    tampered = replace(diagnosis, selection=replace(diagnosis.selection, pairs=fitted_well))
    assert {model.name for model in remaining_models(tampered)} == {COULOMB, ASYMMETRY}


def test_limits_that_leave_no_trial_are_refused(diagnosis):
    with pytest.raises(InputError, match="rows or runs"):
        limits_of(diagnosis.measurement, seconds=4.0)
    with pytest.raises(InputError, match="does not turn"):
        design_trial(diagnosis, limits_of(diagnosis.measurement, row_s=1.0, max_voltage_V=0.1))


def test_options_that_a_kind_of_case_does_not_use_are_refused(symolo, diagnosis, tmp_path):
    with pytest.raises(
        InputError, match=r"--distances is not used for a case of kind motor_steady; allowed: .*--max-voltage"
    ):
        limits_of(diagnosis.measurement, distances_m=(0.1, 0.5))
    made = record(EXAMPLES / "tof_bench_001", tmp_path / "diagnosis")
    for option in (("--max-voltage", 3), ("--one-direction",)):
        ended = symolo("next", made, *option, "--out", tmp_path / "next")
        assert ended.code == 2
        assert f"{made}: {option[0]} is not used for a case of kind tof_bench" in ended.err
        assert "--distances" in ended.err
    assert not (tmp_path / "next").exists()


def test_a_refusal_names_the_folder_of_the_diagnosis(symolo, tmp_path):
    made = record(EXAMPLES / "symolo_csv_001", tmp_path / "diagnosis")
    ended = symolo("next", made, "--out", tmp_path / "next")
    assert ended.code == 2
    assert f"{made}: no trial can be designed for data of kind symolo_csv" in ended.err
    assert "allowed: cases of kind motor_steady, motor_step, tof_bench, drive_log" in ended.err
    assert "data.csv" not in ended.err


def test_data_without_nominal_parameters_lead_to_a_case(diagnosis):
    with pytest.raises(InputError, match=r"data without a nominal.yaml; from a log of your own, .*symolo case init"):
        limits_of(replace(diagnosis.measurement, nominal=None))


def test_what_is_no_diagnosis_or_has_lost_its_case_is_refused(symolo, forward_only, tmp_path):
    ended = symolo("next", forward_only, "--out", tmp_path / "next")
    assert ended.code == 2
    assert "there is no made_from.json" in ended.err
    made = record(tmp_path / "gone", tmp_path / "diagnosis")
    ended = symolo("next", made, "--out", tmp_path / "next")
    assert ended.code == 2
    assert "no longer there" in ended.err
    assert not (tmp_path / "next").exists()
