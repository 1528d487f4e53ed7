"""Cases of the second generator against closed forms of the nominal models."""

import ast
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.diagnosis.independent_cases import judge
from benchmarks.diagnosis.other_robots import __main__ as command
from benchmarks.diagnosis.other_robots import compiled
from benchmarks.diagnosis.other_robots.cases import make_cases
from benchmarks.diagnosis.other_robots.drives.room import box_distance, wall_distance
from benchmarks.diagnosis.other_robots.files import write_case, write_truth
from benchmarks.diagnosis.other_robots.ranges import case as ranges
from benchmarks.diagnosis.other_robots.steady import case as steady

BENCHMARKS = Path(__file__).parents[2] / "benchmarks" / "diagnosis"
GENERATORS = ("independent_cases", "other_robots")
LIBRARIES = {"numpy", "scipy", "yaml"}


def imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{each.name}" for each in node.names)


@pytest.mark.parametrize("generator", GENERATORS)
def test_a_generator_shares_no_code_with_what_it_examines_or_with_the_other_one(generator):
    paths = sorted((BENCHMARKS / generator).rglob("*.py"))
    assert paths
    own = f"benchmarks.diagnosis.{generator}."
    for name in {name for path in paths for name in imported(path)}:
        is_library = name.split(".")[0] in LIBRARIES | sys.stdlib_module_names
        assert is_library or f"{name}.".startswith(own) or name == "benchmarks.diagnosis.independent_cases.judge", name


def column(case, name):
    cells = [row[case.header.index(name)] for row in case.rows]
    return np.array([float(cell) if cell else np.nan for cell in cells])


def robust_sd(values):
    return np.nanmedian(np.abs(values)) / 0.6745


def individual(case):
    entries = [entry for entry in case.nominal["motor"].values() if isinstance(entry, dict)]
    deviations = case.truth["setting"]["deviations"]
    return [e["value"] + x * e["tolerance"] for e, x in zip(entries, deviations, strict=False)]


def test_a_motor_with_nothing_hidden_has_the_steady_states_of_its_equations_and_the_stated_noise():
    current, speed = [], []
    for k in range(8):
        case = steady.make(np.random.default_rng([1, k]), "none")
        assert case is not None
        r, torque_constant, b, tc = individual(case)
        u, noise = column(case, "u_cmd_V"), case.nominal["noise"]
        factors = case.truth["disturbances"]["noise_factor"]
        drive = np.maximum(torque_constant * np.abs(u) / r - tc, 0)
        w = np.sign(u) * drive / (torque_constant**2 / r + b)
        i = (u - torque_constant * w) / r
        current.append((column(case, "current_A") - i) / noise["current_A"] / factors["current_A"])
        moving = (column(case, "omega_rad_s") - w)[w != 0]
        speed.append(moving / noise["omega_rad_s"] / factors["omega_rad_s"])
    assert robust_sd(np.concatenate(current)) == pytest.approx(1, abs=0.1)
    assert robust_sd(np.concatenate(speed)) == pytest.approx(1, abs=0.1)


def test_a_range_sensor_with_nothing_hidden_reads_the_distances_with_the_stated_noise():
    residuals = []
    for k in range(60):
        case = ranges.make(np.random.default_rng([1, k]), "none")
        assert case is not None
        tof, noise, deviations = case.nominal["tof"], case.nominal["noise"], case.truth["setting"]["deviations"]
        d = column(case, "distance_m")
        away = np.maximum(0, d - noise["polynomial_origin_m"])
        sd_m = sum(p * away**power for power, p in enumerate(noise["polynomial_mm"])) / 1000
        expected = deviations[0] * tof["range_offset_m"]["tolerance"]
        expected = expected + d * (1 + deviations[1] * tof["range_scale"]["tolerance"])
        residuals.append((column(case, "reading_m") - expected) / np.sqrt(sd_m**2 + 1e-6 / 12))
    assert robust_sd(np.concatenate(residuals)) == pytest.approx(1, abs=0.1)


def test_the_same_seed_gives_the_same_bytes(tmp_path):
    for run in ("first", "second"):
        motor = steady.make(np.random.default_rng(1), "none")
        assert motor is not None
        motor.truth["case"] = "motor_steady_001"
        for case in [*make_cases("tof_bench", 4, 1), motor]:
            write_case(tmp_path / run / case.truth["case"], case)
            write_truth(tmp_path / run / "truth.json", case.truth)
    paths = sorted(path.relative_to(tmp_path / "first") for path in (tmp_path / "first").rglob("*.*"))
    assert len(paths) == 11
    for path in paths:
        assert (tmp_path / "first" / path).read_bytes() == (tmp_path / "second" / path).read_bytes()


def test_the_judge_finds_an_answer_right_that_repeats_the_truth(tmp_path, capsys):
    truths = []
    for case in make_cases("tof_bench", 20, 1):
        truth = case.truth
        write_truth(tmp_path / "truth.json", truth)
        answer = {"effects": truth["effects"], "unexplained": truth["category"] == "outside"}
        (tmp_path / f"{truth['case']}.json").write_text(json.dumps(answer), encoding="utf-8")
        truths.append(truth)
    judge.run(tmp_path / "truth.json", tmp_path)
    assert "wrong cases (0)" in capsys.readouterr().out
    assert {truth["category"] for truth in truths} == {"one", "two", "none", "outside"}
    assert all(effect["lr"] >= 30 for truth in truths for effect in truth["effects"] + truth["outside"])
    for truth in truths:
        (tmp_path / f"{truth['case']}.json").write_text("{}", encoding="utf-8")
    judge.run(tmp_path / "truth.json", tmp_path)
    assert "wrong cases (17)" in capsys.readouterr().out, "all but three with nothing hidden"


def test_without_a_compiler_the_command_ends_with_one_line(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(compiled.shutil, "which", lambda _: None)
    monkeypatch.setattr("sys.argv", ["other_robots", "--kind", "motor_step", "--out", str(tmp_path)])
    compiled._library.cache_clear()
    with pytest.raises(SystemExit) as end:
        command.main()
    assert end.value.code == 2
    assert capsys.readouterr().err.splitlines() == [
        "motor_step and drive_log need a C compiler (cc, gcc, clang), and none is installed"
    ]


def test_a_compiler_that_fails_is_named_in_one_line(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(compiled.shutil, "which", lambda _: "/bin/false")
    monkeypatch.setattr("sys.argv", ["other_robots", "--kind", "motor_step", "--out", str(tmp_path)])
    compiled._library.cache_clear()
    with pytest.raises(SystemExit) as end:
        command.main()
    assert end.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("/bin/false cannot compile motors.c")


def test_rays_end_at_the_walls_and_at_a_box():
    x, y = np.full(3, 0.5), np.full(3, 0.5)
    angle = np.array([np.pi / 4, 0.0, np.pi])
    d, incidence = wall_distance((2.0, 1.0), x, y, angle)
    assert d == pytest.approx([0.5 * np.sqrt(2), 1.5, 0.5])
    assert incidence == pytest.approx([np.pi / 4, 0, 0])
    assert box_distance((1.0, 0.4, 1.2, 0.7), x, y, angle) == pytest.approx([np.inf, 0.5, np.inf])
