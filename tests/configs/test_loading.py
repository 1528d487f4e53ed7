"""What a good scenario becomes: names, `extends:`, defaults and overrides resolved, each value with its place."""

from pathlib import Path

import pytest

from configs.draw import draw_robot, draw_run
from configs.loader import LoadedScenario, load_scenario, load_section, shipped_robot
from configs.references import locate
from symolo.core.errors import InputError

pytestmark = pytest.mark.usefixtures("here")


def loaded(text: str, *overrides: str) -> LoadedScenario:
    Path("top.yaml").write_text(text)
    return load_scenario("top.yaml", overrides)


def test_a_name_and_a_path_give_the_same_scenario():
    path = locate("scenario", "smoke", folder=Path(), what="scenario")
    by_name, by_path = load_scenario("smoke"), load_scenario(str(path))
    assert by_name.tree == by_path.tree


def test_mappings_merge_deeply_and_lists_replace():
    route = "{name: A, start: {x_m: 0.55, y_m: -0.2, yaw_deg: 0}}"
    scenario = loaded(f"extends: trial.yaml\nstop: {{time_limit_s: 9}}\nroutes: [{route}]\n")
    assert scenario.tree["stop"] == {"lap": False, "time_limit_s": 9}
    assert [(route.name, route.runs) for route in scenario.routes] == [("A", 1)]
    assert scenario.seed == 7


def test_a_distribution_replaces_another_as_a_whole():
    Path("base.yaml").write_text("extends: trial.yaml\nlook: {sun: {elevation_deg: {uniform: [20, 30]}}}\n")
    scenario = loaded("extends: base.yaml\nlook: {sun: {elevation_deg: {normal: [30, 1]}}}\n")
    assert scenario.tree["look"]["sun"]["elevation_deg"] == {"normal": [30, 1]}


def test_the_shipped_robot_is_the_one_that_is_loaded_and_drawn():
    assert shipped_robot() == draw_robot(load_section("robot", "nominal"), 0, "bench")[0]


def test_a_section_mapping_lies_over_the_section_that_is_extended():
    scenario = loaded("extends: trial.yaml\nrobot: {motor: {winding_resistance_ohm: 4}}\n")
    nominal = load_section("robot", "nominal").tree
    assert scenario.tree["robot"]["motor"] == nominal["motor"] | {"winding_resistance_ohm": 4}
    assert scenario.tree["robot"]["drive"] == nominal["drive"]


def test_a_section_by_name_or_with_extends_replaces_the_one_that_is_extended():
    Path("base.yaml").write_text("extends: trial.yaml\nlook: {extends: classroom, sun: {elevation_deg: 12}}\n")
    lab = load_section("look", "lab").tree
    assert loaded("extends: base.yaml\nlook: lab\n").tree["look"] == lab
    over = loaded("extends: base.yaml\nlook: {extends: lab, description: darker}\n").tree["look"]
    assert over == lab | {"description": "darker"}


def test_relative_paths_start_at_the_file_that_names_them():
    Path("deep/looks").mkdir(parents=True)
    Path("deep/looks/mine.yaml").write_text("extends: ../other.yaml\nname: mine\n")
    Path("deep/other.yaml").write_text("extends: lab\ndescription: other\n")
    Path("deep/scenario.yaml").write_text("extends: ../trial.yaml\nlook: looks/mine.yaml\n")
    look = load_scenario("deep/scenario.yaml").tree["look"]
    assert (look["name"], look["description"]) == ("mine", "other")


def test_a_field_left_out_takes_the_default_of_its_place():
    """A tape and a floor are both painted, and each keeps the tint of its own when only the brightness is given."""
    given = loaded("extends: trial.yaml\nlook: {extends: classroom, tape: {paint: {reflectance: 0.1}}}\n")
    default = load_section("look", "classroom").tree["tape"]["paint"]
    assert given.tree["look"]["tape"]["paint"] == default | {"reflectance": 0.1}


def test_every_value_knows_where_it_was_written():
    scenario = loaded("extends: trial.yaml\nrobot:\n  motor:\n    winding_resistance_ohm: 4\n", "routes.CCW.runs=3")
    assert scenario.origins["robot.motor.winding_resistance_ohm"] == "top.yaml:4"
    assert scenario.origins["routes.1.runs"] == "--set routes.CCW.runs"
    assert scenario.origins["routes.0.runs"] == "trial.yaml:4"
    assert scenario.origins["robot.drive.track_m"].rpartition(":")[0].endswith("configs/robots/nominal.yaml")


@pytest.mark.parametrize(
    ("override", "path", "value"),
    [
        ("look.sun.elevation_deg=30", ("look", "sun", "elevation_deg"), 30),
        ("look.sun.elevation_deg={uniform: [20, 30]}", ("look", "sun", "elevation_deg"), {"uniform": [20, 30]}),
        ("routes.0.runs=5", ("routes", 0, "runs"), 5),
        ("routes.CCW.runs=5", ("routes", 1, "runs"), 5),
        ("arena.obstacles.O2.center.0=0.5", ("arena", "obstacles", 1, "center", 0), 0.5),
        ("stop={time_limit_s: 3}", ("stop", "lap"), False),
        ("rates.camera_hz=10", ("rates", "camera_hz"), 10),
        ("arena.walls=[]", ("arena", "walls"), []),
        ("description=a=b", ("description",), "a=b"),
        ("look=lab", ("look", "name"), "lab"),
        ("robot={extends: nominal, name: mine}", ("robot", "name"), "mine"),
    ],
)
def test_an_override_sets_one_place(override: str, path: tuple[str | int, ...], value: object):
    scenario = load_scenario("trial.yaml", [override])
    assert scenario.root.plain_at(path) == value


def test_overrides_apply_in_their_order():
    look = load_scenario("trial.yaml", ["look=lab", "look.sun.illuminance_klx=1", "look.sun.illuminance_klx=2"]).tree[
        "look"
    ]
    assert look["name"] == "lab"
    assert look["sun"]["illuminance_klx"] == 2


def test_a_new_list_item_by_override_takes_its_defaults():
    scenario = load_scenario(
        "trial.yaml", ["arena.obstacles=[{name: A, center: [0, 0]}]", "arena.obstacles.A.size.2=0.3"]
    )
    assert draw_run(scenario, "CW", 1).arena.obstacles[0].size == (0.08, 0.08, 0.3)


def test_overrides_reach_a_section_alone():
    section = load_section("look", "classroom", ["look.sun.elevation_deg=30"])
    assert section.tree["sun"]["elevation_deg"] == 30


@pytest.mark.parametrize(
    ("low", "high"),
    [("{uniform: [0.1, 0.6]}", "{uniform: [0.5, 0.9]}"), ("{choice: [0.6, 0.1]}", "{choice: [0.5, 0.7]}")],
)
def test_a_contradiction_is_found_when_it_takes_the_high_end_of_one_and_the_low_end_of_another(low: str, high: str):
    with pytest.raises(InputError, match="less than max_range_m, which is 0\\.5"):
        load_scenario("trial.yaml", [f"robot.tof.min_range_m={low}", f"robot.tof.max_range_m={high}"])
