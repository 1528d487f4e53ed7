"""Several cases of one robot are one fit: what they share is known better, and what is of one case stays with it."""

import importlib
import json
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.sessions import fitted_errors
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.predictors import STAGES
from diagnosis.report.files import files
from diagnosis.together import joint_nuisances, joint_robot, joint_stages, together
from symolo.core.errors import InputError

GAIN = CandidateEffect(EFFECTS.by_name()["current_sensor_gain"])


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


@pytest.fixture(scope="module")
def benches(motor_bench_case, tmp_path_factory):
    """Two benches of one motor, the second with noise of the current that is three times as large."""
    root = tmp_path_factory.mktemp("benches")
    for name, factor in (("quiet", 1.0), ("loud", 3.0)):
        folder = motor_bench_case(root / name, sweeps=4)
        noise = np.random.default_rng(7)
        header, *rows = (folder / "data.csv").read_text().splitlines()
        cells = [row.split(",") for row in rows]
        for row in cells:
            row[5] = f"{float(row[5]) + 0.001 * np.sqrt(factor**2 - 1.0) * noise.standard_normal():.6f}"
        (folder / "data.csv").write_text("\n".join([header, *(",".join(row) for row in cells)]) + "\n")
        nominal = (folder / "nominal.yaml").read_text()
        assert "current_A: 0.001" in nominal
        (folder / "nominal.yaml").write_text(nominal.replace("current_A: 0.001", f"current_A: {0.001 * factor:g}"))
    return {name: read_measurement(root / name, IMPORTERS) for name in ("quiet", "loud")}


def test_an_error_is_that_of_the_weighted_mean_of_the_cases(benches, robot):
    """A gain alone is linear: its information is the sum of that of the cases, 1/s^2 = 1/s1^2 + 1/s2^2, and its value
    the mean of theirs, weighted with 1/s^2.
    """

    def fitted(stages, nominal):
        hypothesis = Hypothesis(nominal, (), (GAIN,))
        (fit,) = fits(Evidence(stages), [(hypothesis, hypothesis.null())])
        return fit.hypothesis.values(GAIN, fit.x)["gain"], fit.std(GAIN)["gain"]

    single = []
    for case in benches.values():
        nominal = nominal_robot(case.nominal, robot)
        single.append(fitted(STAGES[case.kind](case, nominal), nominal))
    joint = together(tuple(benches.values()))
    nominal = joint_robot(joint, robot)
    value, std = fitted(joint_stages(joint, nominal), nominal)
    weights = [1.0 / s**2 for _, s in single]
    assert single[1][1] == pytest.approx(3.0 * single[0][1], rel=0.15)
    assert std == pytest.approx(sum(weights) ** -0.5, rel=0.01)
    mean = sum(w * v for w, (v, _) in zip(weights, single, strict=True)) / sum(weights)
    assert value == pytest.approx(mean, abs=0.05 * std)


def test_cases_that_contradict_each_other_are_refused(benches):
    loud = benches["loud"]
    spread = loud.nominal.motor.torque_constant_N_m_A
    motor = loud.nominal.motor.model_copy(
        update={"torque_constant_N_m_A": spread.model_copy(update={"value": 2.0 * spread.value})}
    )
    other = replace(loud, nominal=loud.nominal.model_copy(update={"motor": motor}))
    with pytest.raises(InputError, match=r"torque_constant_N_m_A is 0\.6, but 0\.3 in quiet"):
        together((benches["quiet"], other))


@pytest.fixture(scope="module")
def cases(tmp_path_factory, cases_on_the_path):
    """Step logs and a drive of one robot whose supply sags; its wheel has another inertia when it drives."""
    del cases_on_the_path
    made = importlib.import_module("gap_cases")
    root, seed, noise = tmp_path_factory.mktemp("cases"), 3, np.random.default_rng(5)
    drive, step = (made.draw_bench(kind, seed, "few") for kind in ("drive_log", "motor_step"))
    shared = {name: leaf for name, leaf in drive.nominal["motor"].items() if name != "rotor_inertia_kg_m2"}
    step = replace(step, nominal={**step.nominal, "motor": {**step.nominal["motor"], **shared}})
    unit = {name: noise.standard_normal() for name in drive.spreads()}
    sag = (made.Effect("supply_sag", {"source_resistance_ohm": 0.4}),)
    measured = []
    for bench in (step, drive):
        own = {name: value + unit[name] * tolerance for name, (value, tolerance) in bench.spreads().items()}
        case = made.Case(bench.kind, bench, {}, {}, made.World(own, sag), made.Day())
        columns, blind = made.make.KINDS[bench.kind].observe(
            case.true_bench, case.world, np.random.default_rng(11), made.Day()
        )
        made.write(replace(case, columns=columns, blind=blind), root / bench.kind)
        measured.append(read_measurement(root / bench.kind, IMPORTERS))
    return tuple(measured)


def fitted_sag(measurement, robot):
    effect = CandidateEffect(EFFECTS.by_name()["supply_sag"])
    if measurement.cases:
        nominal = joint_robot(measurement, robot)
        stages = joint_stages(measurement, nominal)
        spreads = joint_nuisances(measurement, nominal, Evidence(stages))
    else:
        nominal = nominal_robot(measurement.nominal, robot)
        stages = STAGES[measurement.kind](measurement, nominal)
        spreads = nuisances(measurement.nominal)
    hypothesis = Hypothesis(nominal, spreads, (effect,))
    start = hypothesis.null()
    start[-1] = effect.coordinates[0].start
    (fit,) = fits(Evidence(stages), [(hypothesis, start)])
    return fit, fit.hypothesis.values(effect, fit.x)["source_resistance_ohm"], fit.std(effect)["source_resistance_ohm"]


def test_a_supply_that_sags_is_known_better_by_steps_and_drive_together(cases, robot):
    (_, _, by_step), (_, _, by_drive) = (fitted_sag(case, robot) for case in cases)
    fit, value, std = fitted_sag(together(cases), robot)
    assert std < 0.95 * min(by_step, by_drive)
    assert abs(value - 0.4) < 3.0 * std
    # Both state an inertia of their own, and only the inertia.
    names = [nuisance.name for nuisance in fit.hypothesis.nuisances]
    assert "rotor_inertia_kg_m2" in names
    assert "rotor_inertia_kg_m2 of motor_step" in names
    assert names.count("winding_resistance_ohm") == 1


def test_a_drive_keeps_its_sessions_beside_a_bench_and_one_session_alone_is_none(cases):
    step, drive = cases
    in_two = replace(drive, trials=tuple(replace(trial, session=f"day{k % 2}") for k, trial in enumerate(drive.trials)))
    in_one = replace(drive, trials=tuple(replace(trial, session="day0") for trial in drive.trials))
    sessions = {trial.session for trial in together((step, in_two)).trials}
    assert sessions == {"", f"{drive.name}/day0", f"{drive.name}/day1"}
    assert {trial.session for trial in together((step, in_one)).trials} == {""}


def test_two_drives_of_one_robot_have_sessions_and_one_answer(cases):
    drive = cases[1]
    wheels_alone = replace(drive, nominal=drive.nominal.model_copy(update={"motor": None, "tof": None}))
    first, second = (replace(wheels_alone, name=name) for name in ("monday", "friday"))
    turned = []
    for trial in second.trials:
        channels = [
            replace(channel, series=replace(channel.series, values=channel.values + 0.03))
            if channel.name == "theta_rad"
            else channel
            for channel in trial.channels
        ]
        turned.append(replace(trial, channels=tuple(channels)))
    diagnosis = diagnose(together((first, replace(second, trials=tuple(turned)))))
    assert diagnosis.names == ()
    headings = {e.session: e for e in fitted_errors(diagnosis.fit) if e.effect == "marker_yaw"}
    apart = headings["friday"].value - headings["monday"].value
    assert apart == pytest.approx(0.03, abs=3.0 * np.hypot(headings["friday"].std, headings["monday"].std))
    written = files(diagnosis)
    answer = json.loads(written["answer.json"])
    assert set(answer["cases"]) == {"monday", "friday"}
    assert set(answer["sessions"]) == {"monday", "friday"}
    assert b"name: monday_friday" in written["extended.yaml"].replace(b'"', b"")
