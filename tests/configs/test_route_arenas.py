"""Routes with an arena of their own."""

from pathlib import Path

import pytest
import yaml

from configs.draw import draw_all, draw_run
from configs.loader import LoadedScenario, load_resolved, load_scenario
from symolo.core.errors import InputError

pytestmark = pytest.mark.usefixtures("here")

ROOM = "name: room\nfloor: {half_extent_m: 1.5}\nwalls: [{name: N, start: [-1, 1], end: [1, 1]}]\nobstacles: []\n"
ROUTES = """\
extends: symolo
name: rooms
routes:
  - {name: A, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}}
  - {name: B, start: {x_m: 0.0, y_m: 0.0, yaw_deg: 0}, runs: 2, arena: ARENA}
"""


def scenario(arena: str, *overrides: str) -> LoadedScenario:
    Path("rooms.yaml").write_text(ROUTES.replace("ARENA", arena))
    return load_scenario("rooms.yaml", overrides)


def fault(arena: str, *overrides: str) -> str:
    with pytest.raises(InputError) as caught:
        scenario(arena, *overrides)
    return str(caught.value)


def test_a_route_names_a_shipped_arena_and_the_others_keep_that_of_the_scenario():
    a, b, again = draw_all(scenario("classroom"))
    assert (a.arena.name, b.arena.name, again.arena.name) == ("symolo", "classroom", "classroom")
    assert a.arena.walls == draw_run(load_scenario("symolo"), "CW", 1).arena.walls != b.arena.walls


def test_an_arena_is_a_file_beside_the_scenario_or_has_its_settings_there():
    Path("rooms").mkdir()
    Path("rooms/room.yaml").write_text("extends: symolo\n" + ROOM)
    expected = draw_run(scenario("rooms/room.yaml"), "B", 1).arena
    written = "{extends: symolo, " + ", ".join(ROOM.splitlines()) + "}"
    assert draw_run(scenario(written), "B", 1).arena == expected
    assert [wall.name for wall in expected.walls] == ["N"]


def test_short_forms_are_written_out_in_the_arena_of_a_route():
    polygon = "polygons: [{name: P, robot_is: inside, points: [[-1, -1], [1, -1], [0, 1]]}]"
    arena = draw_run(scenario(f"{{extends: symolo, walls: [], obstacles: [], {polygon}}}"), "B", 1).arena
    assert [wall.name for wall in arena.walls] == ["P_1", "P_2", "P_3"]


def test_each_run_draws_the_numbers_of_its_arena():
    width, extent = "arena.line.width_m", "arena.floor.half_extent_m"
    line = "{extends: classroom, line: {width_m: {uniform: [0.015, 0.020]}}}"
    a, b, again = draw_all(scenario(line, f"{extent}={{uniform: [5, 6]}}"))
    assert a.drawn[extent] == a.arena.floor.half_extent_m
    assert width not in a.drawn
    for spec in (b, again):
        assert extent not in spec.drawn
        assert spec.drawn[width] == spec.arena.line.width_m
    assert b.arena.line.width_m != again.arena.line.width_m


def test_generated_arenas_belong_to_the_routes_that_ask_for_them():
    a, b, again = draw_all(scenario("random"))
    assert a.arena.name == "symolo"
    assert b.arena.name == again.arena.name == "random"
    assert b.arena.line.pieces != again.arena.line.pieces


def test_other_routes_do_not_change_a_run():
    alone = load_scenario("symolo", ["routes=[{name: B, start: {x_m: 0.0, y_m: 0.0, yaw_deg: 0}}]", "arena=random"])
    assert draw_run(scenario("random"), "B", 1).arena == draw_run(alone, "B", 1).arena


def test_the_tree_of_a_released_scenario_gives_the_same_runs():
    loaded = scenario("{extends: classroom, line: {reflectance: {uniform: [0.05, 0.10]}}}")
    tree = yaml.safe_load(yaml.safe_dump(loaded.tree))
    assert draw_all(load_resolved(tree, "metadata.json")) == draw_all(loaded)


def test_the_command_line_sets_the_arena_of_a_route():
    loaded = scenario("classroom", "routes.A.arena=hall", "routes.B.arena.line.width_m=0.02")
    a, b, _ = draw_all(loaded)
    assert (a.arena.name, b.arena.name, b.arena.line.width_m) == ("hall", "classroom", 0.02)


def test_faults_name_the_route():
    assert "rooms.yaml:5: routes.1.arena: got 'hal'" in fault("hal")
    assert "did you mean hall" in fault("hal")
    assert "routes.1.arena.walls.0.end" in fault("{extends: symolo, walls: [{name: N, start: [0, 0]}]}")
    same = "{extends: symolo, walls: [{name: N, start: [0.5, 1], end: [0.5, 1]}]}"
    assert "routes.1.arena.walls.0" in fault(same)
    box = "{extends: symolo, obstacles: [{name: box, center: [0.0, 0.0], size: [0.1, 0.1, 0.1]}]}"
    assert "routes.1.start: the robot of route B would start inside obstacle box" in fault(box)


@pytest.mark.parametrize(
    ("settings", "field", "problem"),
    [
        ("line: {course: {points: [[0, 0], [0.001, 0], [1, 1]]}}", "line.course", ""),
        ("line: {course: {points: [[0, 0], {uniform: [0, 1]}]}}", "line.course.points.1", ""),
        ("polygons: [{name: P, points: [[0, 0], [1, 0]], robot_is: right}]", "polygons.0.robot_is", "allowed"),
        (
            "assets: x\nobstacles: [{name: M, center: [0, 0], mesh: {file: m.stl}}]",
            "obstacles.0.mesh.file",
            "has no triangles",
        ),
        ("extends: nowhere", "extends", "allowed"),
    ],
)
def test_faults_in_courses_polygons_and_mesh_files_name_the_route(settings, field, problem):
    Path("x").mkdir()
    Path("x/m.stl").write_text("solid empty\nendsolid empty\n")
    base = "" if settings.startswith("extends") else "extends: symolo\n"
    Path("room.yaml").write_text(f"{base}{settings}\n")
    text = fault("room.yaml")
    assert f"routes.1.arena.{field}" in text
    assert " arena." not in text
    assert problem in text


def test_the_wrong_arenas_of_all_routes_are_named():
    text = ROUTES.replace("ARENA", "hal").replace("yaw_deg: -90}}", "yaw_deg: -90}, arena: {extends: clasroom}}")
    Path("rooms.yaml").write_text(text)
    with pytest.raises(InputError) as caught:
        load_scenario("rooms.yaml")
    assert "rooms.yaml:4: routes.0.arena.extends: got 'clasroom'" in str(caught.value)
    assert "rooms.yaml:5: routes.1.arena: got 'hal'" in str(caught.value)


def test_a_setting_of_an_arena_that_a_later_name_replaces_is_refused():
    with pytest.raises(InputError, match=r"discards the earlier --set routes.B.arena.line.width_m"):
        scenario("classroom", "routes.B.arena.line.width_m=0.02", "routes.B.arena=hall")


@pytest.mark.parametrize(("first", "second"), [("1", "B"), ("B", "1")])
def test_index_and_name_of_a_route_are_the_same_route(first, second):
    """Whichever of the two comes first, the later name of an arena would discard the width of the line."""
    with pytest.raises(InputError, match=f"discards the earlier --set routes.{first}.arena.line.width_m"):
        scenario("classroom", f"routes.{first}.arena.line.width_m=0.02", f"routes.{second}.arena=hall")
    loaded = scenario("classroom", f"routes.{first}.arena=hall", f"routes.{second}.arena.line.width_m=0.05")
    assert loaded.tree["routes"][1]["arena"]["line"]["width_m"] == 0.05
    assert loaded.tree["routes"][1]["arena"]["name"] == "hall"


def test_a_list_that_replaces_an_earlier_setting_in_it_is_refused():
    routes = "routes=[{name: B, start: {x_m: 0, y_m: 0, yaw_deg: 0}}]"
    with pytest.raises(InputError, match=r"--set routes=.*discards the earlier --set routes.B.runs"):
        scenario("classroom", "routes.B.runs=2", routes)
    assert scenario("classroom", routes, "routes.B.runs=2").routes[0].runs == 2


ALL_OWN = """
extends: symolo
{arena}
routes:
  - {{name: A, arena: symolo, start: {{x_m: 0.55, y_m: -0.20, yaw_deg: -90}}}}
  - {{name: B, arena: classroom, start: {{x_m: -0.10, y_m: -0.15, yaw_deg: 0}}}}
"""


@pytest.mark.parametrize(
    ("arena", "overrides", "where", "setting"),
    [
        ("arena: {line: {width_m: 0.04}}", (), "own.yaml:3", "line.width_m"),
        ("arena: {obstacles: []}", (), "own.yaml:3", "obstacles"),
        ("", ("arena.line.width_m=0.04",), "--set arena.line.width_m", "line.width_m"),
        ("", ("arena=hall",), "--set arena", ""),
    ],
)
def test_settings_of_an_arena_that_no_route_uses_are_refused(arena, overrides, where, setting):
    Path("own.yaml").write_text(ALL_OWN.format(arena=arena))
    with pytest.raises(InputError) as caught:
        load_scenario("own.yaml", overrides)
    message = str(caught.value)
    assert message.startswith(where)
    assert "no route uses it, because each of A, B has an arena of its own" in message
    dot = "." if setting else ""
    assert f"set routes.A.arena{dot}{setting}" in message


def test_an_arena_of_the_scenario_that_no_route_uses_may_be_inherited():
    Path("own.yaml").write_text(ALL_OWN.format(arena=""))
    assert len(load_scenario("own.yaml").routes) == 2


def test_the_arena_of_the_scenario_may_have_settings_if_one_route_uses_it():
    Path("own.yaml").write_text(ALL_OWN.format(arena="arena: {line: {width_m: 0.04}}").replace("arena: symolo, ", ""))
    assert load_scenario("own.yaml").tree["arena"]["line"]["width_m"] == 0.04


def test_a_route_without_an_arena_of_its_own_has_no_fields_of_it():
    with pytest.raises(InputError, match="the route has no arena of its own; name one first") as caught:
        scenario("classroom", "routes.A.arena.line.width_m=0.02")
    assert "or set arena.line.width_m for the arena of the scenario" in str(caught.value)


def test_an_arena_that_is_drawn_as_a_whole_is_refused_with_the_way_to_have_several():
    Path("top.yaml").write_text("extends: symolo\narena: {choice: [symolo, classroom]}\n")
    with pytest.raises(InputError, match="give routes an `arena` of their own"):
        load_scenario("top.yaml")


@pytest.mark.parametrize("routes", ["null", "[]"])
def test_a_scenario_without_routes_is_refused_for_that_and_not_for_its_arena(routes):
    Path("none.yaml").write_text(f"extends: smoke\narena: symolo\nroutes: {routes}\n")
    with pytest.raises(InputError, match=r"none\.yaml:3: routes"):
        load_scenario("none.yaml", ["arena.line.width_m=0.02"])
