"""What the documents state about robots with effects, and about robots that are drawn from a diagnosis."""

import json

import pytest

import symolo as library
from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.assembly.description import markdown
from symolo.dataset.documents.metadata import RunRecord, describe, read_metadata
from symolo.dataset.documents.robots import SimulatedRobots
from symolo.publishing.documents.responsible_ai import responsible_ai
from symolo.reader.balance import balance
from tests.symolo.conftest import drive

POSTERIOR = """\
version: 1
source: bench (motor_steady)
robot: nominal
something_else: 0.03
unexplained: ""
hypotheses:
  - name: torque_constant_scale
    weight: 1.0
    left_out: [gear_backlash]
    not_determined: []
    fixed: []
    numbers:
      - {field: effects.torque_constant_scale.scale, unit: "1", scale: linear, mean: 0.9, low: 0.8, high: 1.0,
         replaces: null}
    factor: [[0.01]]
    effect_ranges:
      - {effect: torque_constant_scale, quantity: voltage_V, low: 0.5, high: 5}
  - name: wheel_radius_asymmetry
    weight: 0.0
    left_out: []
    not_determined: []
    fixed: []
    numbers:
      - {field: effects.wheel_radius_asymmetry.asymmetry, unit: "1", scale: linear, mean: 0.0, low: -1.0, high: 1.0,
         replaces: null}
    factor: [[0.01]]
    effect_ranges: []
measured: []
noise: []
"""


@pytest.fixture
def like(tmp_path):
    """Setting that draws the robots from a diagnosis, whose second hypothesis has no weight."""
    (tmp_path / "posterior.yaml").write_text(POSTERIOR)
    return f"like={tmp_path}"


def described(painted, *settings):
    root = painted(settings=settings)
    return root, read_metadata(root)


def limits(metadata):
    return responsible_ai(metadata)["rai:dataLimitations"]


def test_robots_of_a_diagnosis_are_not_as_their_data_sheet_says(painted, like):
    _, metadata = described(painted, like)
    specs = draw_all(load_scenario("smoke", [like]))
    driven = {effect.name for spec in specs for effect in spec.robot.effects}
    robots = SimulatedRobots.from_metadata(metadata)
    assert set(robots.effects) == driven == {"torque_constant_scale"}
    assert (robots.diagnosis, robots.left_out) == ("bench (motor_steady)", ("gear_backlash",))
    text = " ".join(limits(metadata))
    assert "as its data sheet says" not in text
    assert "drawn from the diagnosis of bench (motor_steady), which extends nominal" in text
    assert "torque_constant_scale" in text
    assert "A diagnosis observed torque_constant_scale only where voltage_V is from 0.5 to 5." in limits(metadata)


def test_the_readme_of_a_release_names_the_diagnosis_and_the_effects(painted, like):
    _, metadata = described(painted, like)
    text = markdown(metadata, draw_all(load_scenario("smoke", [like]))[0]).decode()
    (line,) = [line for line in text.splitlines() if "bench" in line]
    assert "torque" in line
    _, plain = described(painted)
    assert "effect" not in markdown(plain, draw_all(load_scenario("smoke"))[0]).decode()


def test_the_table_of_the_splits_names_the_diagnosis(painted, like, copy_of, sign):
    root, _ = described(painted, like)
    root = copy_of(root)
    metadata = json.loads((root / "metadata.json").read_bytes())
    runs = [run["run"] for run in metadata["runs"]]
    splits = {"by": "run", "seed": 1, "runs": {"train": runs[:1], "test": runs[1:]}}
    (root / "metadata.json").write_text(json.dumps(metadata | {"splits": splits}))
    sign(root)
    content = balance(library.load(root))
    assert content is not None
    assert (
        dict(content.rows)["robots"] == ["nominal as in the diagnosis bench (motor_steady) (torque_constant_scale)"] * 2
    )


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        (("robot.motor.coulomb_friction_N_m={uniform: [0.01, 0.02]}",), "Numbers of the robot are drawn for each run"),
        (
            ("robot.effects.supply_sag.source_resistance_ohm=0.3",),
            "Deviations of the robot from its data sheet: supply_sag.",
        ),
    ],
)
def test_without_a_diagnosis_the_settings_of_the_robot_decide(settings, text):
    loaded = load_scenario("smoke", list(settings))
    specs = draw_all(loaded)
    assert text in SimulatedRobots.from_metadata(fake_metadata(loaded.tree, specs)).text


def test_a_robot_of_which_nothing_is_drawn_is_as_its_settings_say():
    loaded = load_scenario("smoke")
    metadata = fake_metadata(loaded.tree, [spec.model_copy(update={"drawn": {}}) for spec in draw_all(loaded)])
    assert (
        SimulatedRobots.from_metadata(metadata).text
        == "The robot is as its settings say; it has no effect beyond them."
    )


@pytest.mark.parametrize(
    "damaged", [{"like": 3}, {"like": {"hypotheses": [4]}}, {"robot": []}, {"robot": {"effects": 1}}]
)
def test_settings_of_a_stranger_that_do_not_fit_state_nothing(damaged):
    loaded = load_scenario("smoke")
    metadata = fake_metadata(loaded.tree | damaged, draw_all(loaded))
    assert SimulatedRobots.from_metadata(metadata).is_as_set


def fake_metadata(tree, specs):
    records = [RunRecord.from_specification(spec, drive(), None) for spec in specs]
    return describe(tree, specs, records, ())
