from pathlib import Path
from unittest.mock import Mock

import pytest
import yaml

from configs.draw import draw_all, draw_look, draw_render, draw_robot, draw_run
from configs.loader import LoadedScenario, load_scenario, load_section
from configs.schema.scenario import RunSpec
from configs.validation import values
from symolo.core.errors import InputError
from symolo.core.yaml.tree import Node

pytestmark = pytest.mark.usefixtures("here")

DRAWN = """\
robot:
  extends: nominal
  motor: {winding_resistance_ohm: {uniform: [2.5, 3.5]}, torque_constant_N_m_A: {normal: [0.31, 0.01]}}
  tof: {rays: {uniform: [60, 90]}, noise_scale: {log_uniform: [0.5, 2]}}
arena:
  extends: symolo
  walls:
    - {name: A, start: [-0.05, 0.9], end: [-0.85, 0.9], surface: {choice: [wood, metal, glass, paper]}}
  obstacles:
    - {name: B, center: [{uniform: [-0.5, -0.4]}, 0.0]}
render: {denoise: {choice: [true, false]}}
"""


def loaded(text: str = DRAWN, *overrides: str) -> LoadedScenario:
    Path("top.yaml").write_text("extends: trial.yaml\nlook: {extends: lab, lamps: {flux_klm: 4}}\n" + text)
    return load_scenario("top.yaml", overrides)


def test_every_drawn_value_is_listed_by_its_path_and_stands_in_the_specification():
    spec = draw_run(loaded(), "CW", 1)
    assert {path: value for path, value in spec.drawn.items() if not path.startswith("look.")} == {
        "arena.obstacles.0.center.0": spec.arena.obstacles[0].center[0],
        "arena.walls.0.surface": spec.arena.walls[0].surface,
        "render.denoise": spec.render.denoise,
        "robot.motor.torque_constant_N_m_A": spec.robot.motor.torque_constant_N_m_A,
        "robot.motor.winding_resistance_ohm": spec.robot.motor.winding_resistance_ohm,
        "robot.tof.noise_scale": spec.robot.tof.noise_scale,
        "robot.tof.rays": spec.robot.tof.rays,
    }


def test_values_have_the_type_of_their_field():
    drawn = draw_run(loaded(DRAWN, "robot.power.battery_voltage_V={choice: [7, 8]}"), "CW", 1).drawn
    assert type(drawn["robot.tof.rays"]) is int
    assert type(drawn["robot.power.battery_voltage_V"]) is float
    assert type(drawn["render.denoise"]) is bool


def test_the_same_seed_draws_the_same_and_another_seed_draws_other_values():
    first, again = draw_run(loaded(), "CW", 1), draw_run(loaded(), "CW", 1)
    other = draw_run(loaded(DRAWN, "seed=8"), "CW", 1)
    assert first == again
    path = "robot.motor.winding_resistance_ohm"
    assert first.drawn[path] != other.drawn[path]


def test_a_new_random_field_leaves_every_other_draw_as_it_was():
    before = draw_run(loaded(), "CW", 1).drawn
    after = draw_run(loaded(DRAWN, "robot.drive.wheel_friction={uniform: [0.7, 1.0]}"), "CW", 1).drawn
    assert after.items() - before.items() == {("robot.drive.wheel_friction", after["robot.drive.wheel_friction"])}
    assert before.items() <= after.items()


def test_a_change_of_one_distribution_leaves_the_other_draws_as_they_were():
    path = "robot.motor.winding_resistance_ohm"
    before = draw_run(loaded(), "CW", 1).drawn
    after = draw_run(loaded(DRAWN, f"{path}={{normal: [3, 0.1]}}"), "CW", 1).drawn
    assert {key for key in before if before[key] != after[key]} == {path}


def test_the_order_in_the_file_does_not_matter():
    turned = yaml.safe_dump(_reversed(yaml.safe_load(DRAWN)), sort_keys=False)
    assert turned.index("render:") < turned.index("arena:") < turned.index("robot:")
    specs = [draw_run(loaded(text), "CW", 1) for text in (DRAWN, turned)]
    assert specs[0].model_dump_json() == specs[1].model_dump_json()


def _reversed(value: object) -> object:
    return {key: _reversed(item) for key, item in reversed(value.items())} if isinstance(value, dict) else value


def test_runs_and_routes_draw_apart_from_each_other():
    scenario = loaded()
    values = [spec.drawn["robot.motor.winding_resistance_ohm"] for spec in draw_all(scenario)]
    assert len(set(values)) == len(values) == 3


@pytest.mark.parametrize("change", ["routes.CW.runs=9", "routes.CCW.runs=9", "stop.time_limit_s=20"])
def test_more_runs_of_any_route_leave_a_run_as_it_was(change: str):
    assert draw_run(loaded(), "CW", 2).drawn == draw_run(loaded(DRAWN, change), "CW", 2).drawn


def test_a_route_before_it_leaves_the_draws_of_a_route_as_they_were():
    start = "start: {x_m: {uniform: [0.54, 0.56]}, y_m: -0.2, yaw_deg: 90}"
    alone = loaded(DRAWN + f"routes: [{{name: A, {start}}}]\n")
    after = loaded(DRAWN + f"routes: [{{name: B, {start}}}, {{name: A, {start}}}]\n")
    assert draw_run(alone, "A", 1) == draw_run(after, "A", 1)
    assert "start.x_m" in draw_run(alone, "A", 1).drawn
    assert draw_run(after, "A", 1).start.x_m != draw_run(after, "B", 1).start.x_m


def test_all_runs_come_in_the_order_of_routes_and_runs():
    assert [spec.key for spec in draw_all(loaded())] == ["CW/test_1", "CW/test_2", "CCW/test_1"]


def test_a_specification_survives_its_json_to_the_byte():
    for spec in draw_all(loaded()):
        text = spec.model_dump_json()
        assert RunSpec.model_validate_json(text) == spec
        assert RunSpec.model_validate_json(text).model_dump_json() == text


def test_a_look_drawn_alone_with_the_runs_key_is_the_look_of_the_run():
    scenario = load_scenario("trial.yaml")
    for spec in draw_all(scenario):
        look, drawn = draw_look(load_section("look", "classroom"), scenario.seed, spec.route, spec.run)
        assert look == spec.look
        assert drawn == {path: value for path, value in spec.drawn.items() if path.startswith("look.")}


def test_image_settings_and_a_robot_drawn_alone_with_the_runs_key_are_those_of_the_run():
    only = "robot.power.battery_voltage_V={choice: [7]}"
    scenario = loaded(DRAWN, "render.samples={uniform: [10, 10000]}", only)
    Path("drawn.yaml").write_text(yaml.safe_dump(yaml.safe_load(DRAWN)["robot"]))
    for spec in draw_all(scenario):
        key = (spec.route, spec.run)
        assert draw_render(scenario, scenario.seed, *key) == spec.render
        robot, drawn = draw_robot(load_section("robot", "drawn.yaml", (only,)), scenario.seed, *key)
        assert robot == spec.robot
        assert drawn == {path: value for path, value in spec.drawn.items() if path.startswith("robot.")}


def test_a_draw_that_makes_an_impossible_world_is_refused_with_its_run():
    """Both ends are free; only what lies between them blocks the start."""
    scenario = loaded(
        DRAWN.replace("[{uniform: [-0.5, -0.4]}, 0.0]", "[0.55, {uniform: [-0.6, 0.2]}]"), "routes.CW.runs=50"
    )
    expected = (
        r"^trial\.yaml:4: routes\.0\.start: the robot of route CW would start inside obstacle B.*drawn for CW run \d+"
    )
    with pytest.raises(InputError, match=expected):
        draw_all(scenario)


def test_an_impossible_draw_of_a_later_route_is_refused_at_its_place_in_the_file():
    start = "start: {x_m: 0.55, y_m: -0.2, yaw_deg: 90}"
    crossing = "start: {x_m: 0.55, y_m: {uniform: [-0.2, 0.3]}, yaw_deg: 90}"
    obstacle = "arena: {extends: symolo, obstacles: [{name: Box, center: [0.55, 0.0], size: [0.02, 0.02, 0.1]}]}\n"
    routes = f"routes:\n  - {{name: A, {start}}}\n  - {{name: B, {start}}}\n  - {{name: C, {crossing}, runs: 50}}\n"
    expected = r"^top\.yaml:7: routes\.2\.start: the robot of route C would start inside obstacle Box.*for C run \d+;"
    with pytest.raises(InputError, match=expected):
        draw_all(loaded(obstacle + routes))


def test_the_work_for_a_run_does_not_grow_with_the_number_of_routes(monkeypatch: pytest.MonkeyPatch):
    def filled_nodes(count: int) -> int:
        start = "start: {x_m: {uniform: [0.54, 0.56]}, y_m: -0.2, yaw_deg: 90}"
        routes = ", ".join(f"{{name: R{number}, {start}}}" for number in range(count))
        scenario = loaded(DRAWN + f"routes: [{routes}]\n")
        plain, read = Node.plain, []
        with monkeypatch.context() as patch:
            patch.setattr(values, "_filled", drawn := Mock(wraps=values._filled))
            patch.setattr(Node, "plain", lambda node: read.append(node) or plain(node))
            draw_run(scenario, f"R{count - 1}", 1)
        return drawn.call_count + len(read)

    assert filled_nodes(2) == filled_nodes(40) > 10


def test_an_unknown_route_is_refused():
    with pytest.raises(InputError, match="route: got 'CWW', allowed: CW, CCW"):
        draw_run(loaded(), "CWW", 1)
