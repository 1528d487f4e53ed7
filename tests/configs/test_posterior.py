"""Robots that are drawn from the posterior of a diagnosis."""

import hashlib
import math
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
import yaml

from configs.draw import draw_all, draw_run
from configs.loader import load_resolved, load_scenario
from configs.posterior.drawing import drawn_hypothesis, drawn_robot
from configs.posterior.schema import FILE
from symolo.core.errors import InputError
from symolo.core.random_streams import stream

pytestmark = pytest.mark.usefixtures("here")

POSTERIOR = """\
version: 1
source: bench (motor_steady)
robot: nominal
something_else: 0.03
unexplained: ""
hypotheses:
  - name: torque_constant_scale
    weight: 0.75
    left_out: []
    not_determined: []
    fixed:
      - {field: power.motor_voltage_limit_V, value: 7.4, replaces: 6.0}
    numbers:
      - {field: motor.winding_resistance_ohm, unit: ohm, scale: log, mean: 1.0, low: 0, high: 1000, replaces: 2.8535329}
      - {field: effects.torque_constant_scale.scale, unit: "1", scale: linear, mean: 0.9, low: 0.88, high: 2,
         replaces: null}
    factor: [[0.1], [0.016, 0.012]]
    effect_ranges:
      - {effect: torque_constant_scale, quantity: voltage_V, low: 0.5, high: 5}
  - name: no effect
    weight: 0.25
    left_out: [gear_backlash]
    not_determined: []
    fixed: []
    numbers:
      - {field: motor.winding_resistance_ohm, unit: ohm, scale: log, mean: 1.1, low: 0, high: 1000, replaces: 2.8535329}
    factor: [[0.1]]
    effect_ranges: []
measured:
  - {covariate: u_cmd_V, quantity: voltage_V, low: 0, high: 5}
noise:
  - {channel: current_A, unit: A, sd: 0.001, level: 1.1, outliers: 0.01}
"""
DRAWS = 250
CODE = "raise SystemExit"
CODE_SHA256 = hashlib.sha256(CODE.encode()).hexdigest()


def written(text: str = POSTERIOR, folder: str = "diagnosis") -> str:
    Path(folder).mkdir(exist_ok=True)
    (Path(folder) / FILE).write_text(text)
    return f"like={folder}"


def robots(loaded, *, of=0, count=DRAWS):
    hypothesis = loaded.like.hypotheses[of]
    root = loaded.single_routes["CW"].root
    return [drawn_robot(root, hypothesis, {}, stream(1, "robots", n)).numbers for n in range(count)]


def test_numbers_are_drawn_together_with_the_stated_covariance_within_their_bounds():
    """The scale is cut off 1 sd below its mean: its mean becomes m + s phi(1) / Phi(1), and the resistance with it."""
    numbers = robots(load_scenario("trial.yaml", [written()]))
    logs = np.log([each["motor.winding_resistance_ohm"] for each in numbers])
    scales = np.array([each["effects.torque_constant_scale.scale"] for each in numbers])
    assert scales.min() >= 0.88
    normal, sd, correlation = NormalDist(), math.hypot(0.016, 0.012), 0.8
    shift = normal.pdf(1.0) / normal.cdf(1.0)
    variance = 1.0 - shift * (1.0 + shift)
    sigmas = 4.0 / math.sqrt(DRAWS)
    assert np.mean(scales) == pytest.approx(0.9 + sd * shift, abs=sigmas * sd)
    assert np.std(scales) == pytest.approx(sd * math.sqrt(variance), rel=sigmas)
    assert np.mean(logs) == pytest.approx(1.0 + 0.1 * correlation * shift, abs=sigmas * 0.1)
    covariance = correlation * 0.1 * sd * variance
    assert np.cov(logs, scales)[0, 1] == pytest.approx(covariance, rel=sigmas / correlation)


def test_hypotheses_are_drawn_as_often_as_their_weights_say():
    like = load_scenario("trial.yaml", [written()]).like
    names = [drawn_hypothesis(like, stream(1, "hypotheses", n)).name for n in range(1000)]
    assert names.count("no effect") == pytest.approx(250, abs=4 * math.sqrt(1000 * 0.25 * 0.75))


def test_a_run_states_its_source_its_hypothesis_and_its_numbers():
    loaded = load_scenario("trial.yaml", [written()])
    for spec in draw_all(loaded):
        assert spec.like.sha256 == loaded.like.sha256
        assert spec.drawn["like.hypothesis"] == spec.like.hypothesis
        assert spec.drawn["robot.motor.winding_resistance_ohm"] == spec.robot.motor.winding_resistance_ohm
        effects = {"torque_constant_scale"} if spec.like.hypothesis != "no effect" else set()
        assert {effect.name for effect in spec.robot.effects} == effects
        assert spec.robot.power.motor_voltage_limit_V == (7.4 if effects else 6.0)
        assert len(spec.robot.effect_ranges) == len(effects)


def test_a_run_states_the_measured_ranges_of_what_it_has_too():
    text = POSTERIOR.replace("noise:\n", "  - {covariate: temperature_C, quantity: null, low: 20, high: 30}\nnoise:\n")
    (measured,) = draw_run(load_scenario("trial.yaml", [written(text)]), "CW", 1).like.measured
    assert (measured.quantity, measured.low, measured.high) == ("voltage_V", 0, 5)


def test_the_resolved_scenario_draws_the_same_runs_without_the_file_and_one_run_alone_is_the_same():
    loaded = load_scenario("trial.yaml", [written()])
    tree, specs = loaded.tree, draw_all(loaded)
    (Path("diagnosis") / FILE).unlink()
    assert draw_all(load_resolved(tree, "metadata.json")) == specs
    assert draw_run(loaded, "CCW", 1) == specs[-1]
    assert specs[0].robot.motor != specs[1].robot.motor


def test_a_scenario_file_may_name_the_posterior_relative_to_itself(here):
    (here / "deep").mkdir()
    written(folder="deep/diagnosis")
    Path("deep/top.yaml").write_text("extends: ../trial.yaml\nlike: diagnosis\n")
    assert load_scenario("deep/top.yaml").like.source == "bench (motor_steady)"
    assert load_scenario("deep/top.yaml", [f"like=deep/diagnosis/{FILE}"]).like is not None
    assert load_scenario("deep/top.yaml", ["like=null"]).like is None


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("version: 1", "version: 2", "posterior.yaml:1: like: version of the file: got 2, allowed: 1"),
        ("version: 1\n", "", "states no version"),
        ("weight: 0.75", "weight: 0.5", "weights with the sum 0.75"),
        ("[0.016, 0.012]", "[0.016, 0.012, 0.1]", "posterior.yaml:17: hypotheses.0.factor: got '3 numbers in row 2'"),
        ("[[0.1], [0.016, 0.012]]", "[[0.1]]", "1 rows"),
        ("mean: 1.0", "mean: .nan", "posterior.yaml:14: hypotheses.0.numbers.0.mean"),
        ("noise:", "noises:", "did you mean noise"),
        ("robot: nominal", "robot: scout", "robot.name: the diagnosis of --like is of another robot"),
        ("motor.winding_resistance_ohm", "camera.x_m", "hypotheses.0.numbers.0.field"),
        ("motor.winding_resistance_ohm", "motor.winding_ohm", "robot.motor.winding_ohm: unknown key"),
        (POSTERIOR[400:], "", "posterior.yaml"),
    ],
)
def test_a_file_that_does_not_fit_is_refused_with_its_place(before, after, message):
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        load_scenario("trial.yaml", [written(POSTERIOR.replace(before, after))])


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("robot=fleet", "robot.name: the diagnosis of --like is of another robot"),
        ("robot.motor.winding_resistance_ohm={uniform: [2, 3]}", "the scenario draws it, and --like too"),
        ("robot.motor.winding_resistance_ohm=3", "the scenario sets it, and --like too: got 3"),
        (
            "robot.effects.torque_constant_scale.scale=1.1",
            "robot.effects.torque_constant_scale.scale: the scenario sets",
        ),
        (
            "robot.power.motor_voltage_limit_V=7",
            "got 7, allowed: 6.0, as the robot nominal has it; leave it out, and its value comes from posterior.yaml",
        ),
    ],
)
def test_a_number_that_the_scenario_chooses_itself_is_an_error_with_its_key(override, message):
    with pytest.raises(InputError) as error:
        load_scenario("trial.yaml", [written(), override])
    assert message in f"{override.partition('=')[0]}: {error.value}"


def with_supply(battery_V: float = 6.88) -> str:
    """Return the posterior whose first hypothesis also has a supply that differs from that of the nominal robot."""
    supply = f"      - {{field: power.battery_voltage_V, value: {battery_V}, replaces: 7.4}}\n"
    return POSTERIOR.replace("    numbers:\n", f"{supply}    numbers:\n", 1)


def test_a_draw_of_a_shipped_scenario_gives_way_to_the_posterior():
    """`smoke` draws the supply, which the diagnosis determines; other draws stay."""
    loaded = load_scenario("smoke", [written(with_supply()), "routes.0.runs=8"])
    assert loaded.replaced_draws == ("robot.power.battery_voltage_V",)
    for spec in draw_all(loaded):
        named = spec.like.hypothesis != "no effect"
        assert spec.robot.power.battery_voltage_V == (6.88 if named else 7.4)
        assert "robot.drive.wheel_friction" in spec.drawn
    assert draw_all(load_resolved(loaded.tree, "metadata.json")) == draw_all(loaded)
    assert load_scenario("smoke").replaced_draws == ()
    assert load_scenario("smoke", [written(folder="other")]).replaced_draws == ()


@pytest.mark.parametrize("voltage", ["7.0", "{uniform: [7.0, 8.2]}"])
def test_a_supply_that_the_user_sets_does_not_give_way(voltage, here):
    with pytest.raises(InputError, match="and --like too"):
        load_scenario("smoke", [written(with_supply()), f"robot.power.battery_voltage_V={voltage}"])
    (here / "own.yaml").write_text(f"extends: smoke\nrobot: {{power: {{battery_voltage_V: {voltage}}}}}\n")
    with pytest.raises(InputError, match=r"own\.yaml:2: .*and --like too"):
        load_scenario("own.yaml", [written(with_supply())])


def test_another_number_of_the_scenario_stays_and_may_be_drawn():
    loaded = load_scenario("trial.yaml", [written(), "robot.motor.coulomb_friction_N_m={uniform: [0.01, 0.02]}"])
    plain = load_scenario("trial.yaml", ["robot.motor.coulomb_friction_N_m={uniform: [0.01, 0.02]}"])
    frictions = [draw_run(each, "CW", 1).robot.motor.coulomb_friction_N_m for each in (loaded, plain)]
    assert frictions[0] == frictions[1]


def test_a_hypothesis_whose_robots_are_all_impossible_is_an_error(monkeypatch):
    monkeypatch.setattr("configs.posterior.drawing.MAX_ATTEMPTS", 20)
    text = POSTERIOR.replace("low: 0.88, high: 2", "low: 1.9, high: 2")
    with pytest.raises(InputError, match=r"20 robots of torque_constant_scale were drawn, and all are impossible"):
        robots(load_scenario("trial.yaml", [written(text)]), count=1)


def packed_scenario(here, change=None) -> Path:
    """Return the scenario of a publication: the resolved settings in a folder without the posterior file."""
    tree = load_scenario("trial.yaml", [written()]).tree
    if change:
        change(tree["like"])
    (here / "upload").mkdir()
    path = here / "upload/scenario.yaml"
    path.write_text(yaml.safe_dump(tree, sort_keys=False))
    return path


def test_a_scenario_with_the_whole_posterior_in_place_of_its_path_draws_the_same_runs(here):
    loaded = load_scenario("trial.yaml", [written()])
    path = packed_scenario(here)
    (here / "diagnosis" / FILE).unlink()
    again = load_scenario(str(path))
    assert again.tree == loaded.tree
    assert draw_all(again) == draw_all(loaded)
    assert load_scenario(str(path), ["like=null"]).like is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda like: like.update(sha256="0"), "like.sha256"),
        (lambda like: like.pop("sha256"), "like.sha256: missing"),
        (lambda like: like.update(version=2), "like.version"),
        (lambda like: like["hypotheses"][0].update(weight=0.5), "like.hypotheses"),
        (lambda like: like["hypotheses"][0]["numbers"][0].update(mean=math.nan), "like.hypotheses.0.numbers.0.mean"),
        (lambda like: like["hypotheses"][0]["numbers"][0].update(field="camera.x_m"), "numbers.0.field"),
        (lambda like: like["hypotheses"][0]["numbers"][0].update(mean={"uniform": [0.9, 1.1]}), "numbers.0.mean"),
        (lambda like: like.update(noises=[]), "like.noises: unknown key"),
        (lambda like: like.update(hypotheses=[]), "like.hypotheses"),
        (lambda like: like.update(robot="scout"), "the diagnosis of --like is of another robot"),
        (
            lambda like: like.update(
                effect_files=[{"name": "magnet", "file": "magnet.py", "sha256": CODE_SHA256, "text": CODE}]
            ),
            "like.effect_files: magnet.py is not loaded",
        ),
    ],
)
def test_a_posterior_within_a_scenario_is_checked_like_a_file(change, message, here):
    path = packed_scenario(here, change)
    with pytest.raises(InputError) as error:
        load_scenario(str(path))
    assert message in str(error.value)
    assert "scenario.yaml:" in str(error.value)
