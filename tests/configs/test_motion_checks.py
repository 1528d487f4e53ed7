"""Paths of moving obstacles: what is refused, in one line at its place, and what a file may leave out."""

import json

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.validation.json_schema import scenario_json_schema
from symolo.core.errors import InputError

REFUSED = {
    "no waypoints": ("{waypoints: []}", "waypoints", "a list with at least 1 item"),
    "a waypoint at the start": (
        "{waypoints: [{t_s: 0, offset: [0.1, 0]}]}",
        "waypoints.0.t_s",
        "leave this waypoint out",
    ),
    "a place of its own": ("{waypoints: [{t_s: 1, center: [0, 0]}]}", "waypoints.0.center", "offset"),
    "an unknown repeat": (
        "{repeat: bounce, waypoints: [{t_s: 1}]}",
        "repeat",
        "one of once, loop, back_and_forth",
    ),
    "a drawn repeat that is unknown": (
        "{repeat: {choice: [once, twice]}, waypoints: [{t_s: 1}]}",
        "repeat",
        "one of once, loop, back_and_forth",
    ),
    "times that stand still": (
        "{waypoints: [{t_s: 2}, {t_s: 2, offset: [0.1, 0]}]}",
        "waypoints.1.t_s",
        "times must increase: got 2.0, allowed: more than 2, the time before it",
    ),
    "times that may cross": (
        "{waypoints: [{t_s: {uniform: [1, 3]}}, {t_s: 2.5}]}",
        "waypoints.1.t_s",
        "allowed: more than 3",
    ),
    "too fast": (
        "{waypoints: [{t_s: 1, offset: [0.1, 0]}, {t_s: 1.1, offset: [0.4, 0.4]}]}",
        "waypoints.1.offset",
        "too fast: got '5 m/s', allowed: at most 2 m/s; allow at least 0.25 s for the 0.5 m",
    ),
    "turning too fast": (
        "{waypoints: [{t_s: 1, turn_deg: 720}]}",
        "waypoints.0.turn_deg",
        "got '720 deg/s', allowed: at most 360 deg/s; allow at least 2 s for the 720 deg",
    ),
    "an open loop": (
        "{repeat: loop, waypoints: [{t_s: 1, offset: [0.1, 0]}]}",
        "waypoints.0",
        "the loop is not closed",
    ),
    "a loop with half a turn": (
        "{repeat: loop, waypoints: [{t_s: 1, turn_deg: 180}]}",
        "waypoints.0",
        "the loop is not closed",
    ),
    "off the floor": ("{waypoints: [{t_s: 5, offset: [4, 0]}]}", "waypoints.0.offset", "beyond the edge of the floor"),
    "through a wall": (
        "{waypoints: [{t_s: 5, offset: [-1.2, 0]}]}",
        "waypoints.0",
        "the path leads through wall B",
    ),
    "through an obstacle": (
        "{waypoints: [{t_s: 1}, {t_s: 5, offset: [0.5, 0.15]}]}",
        "waypoints.1",
        "the path leads through obstacle O2",
    ),
}


def scenario(text, motion, center="[0.1, 0.0]"):
    obstacles = [
        "{name: O2, center: [0.55, 0.15]}",
        f"{{name: Cart, center: {center}, motion: {motion}}} #!",
    ]
    lines = "\n".join(f"    - {obstacle}" for obstacle in obstacles)
    return text.replace("arena: symolo", f"arena:\n  extends: symolo\n  obstacles:\n{lines}")


def test_the_schema_refuses_a_waypoint_at_the_start_as_the_check_does():
    definition = scenario_json_schema()["$defs"]["Waypoint"]["properties"]["t_s"]
    assert '"exclusiveMinimum": 0' in json.dumps(definition)
    assert '"minimum"' not in json.dumps(definition)


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_an_impossible_path_is_refused_in_one_line(case, here, scenario_text):
    motion, field, telling = case
    text = scenario(scenario_text, motion)
    (here / "bad.yaml").write_text(text)
    line = next(number for number, line in enumerate(text.splitlines(), 1) if "#!" in line)
    with pytest.raises(InputError) as caught:
        load_scenario("bad.yaml")
    message = str(caught.value)
    assert message.startswith(f"bad.yaml:{line}: arena.obstacles.1.motion.{field}")
    assert telling in message
    assert len(message.splitlines()) == 1


def test_a_box_on_the_start_at_the_beginning_is_refused(here, scenario_text):
    """Where it goes later is the run's own affair."""
    away = "{waypoints: [{t_s: 5, offset: [0.5, 0]}]}"
    (here / "bad.yaml").write_text(scenario(scenario_text, away, center="[0.6, -0.2]"))
    with pytest.raises(InputError, match="route CW would start inside obstacle Cart"):
        load_scenario("bad.yaml")
    towards = "{waypoints: [{t_s: 5, offset: [-0.5, 0]}]}"
    (here / "good.yaml").write_text(scenario(scenario_text, towards, center="[1.1, -0.2]"))
    load_scenario("good.yaml")


def test_a_turning_box_is_refused_where_only_its_corner_meets_the_wall(here, scenario_text):
    """Beside wall B's back, 0.08 m wide: 5 mm away square, its corner reaches 17 mm further at 45 degrees."""
    motion = "{{waypoints: [{{t_s: 5, turn_deg: {turn}}}]}}"
    # The back of B is its face moved 20 mm; near its middle the face is at x = -0.505.
    for center, turn, good in (("[-0.42, -0.2]", 45, True), ("[-0.435, -0.2]", 45, False)):
        (here / "turn.yaml").write_text(scenario(scenario_text, motion.format(turn=turn), center=center))
        if good:
            load_scenario("turn.yaml")
        else:
            with pytest.raises(InputError, match="leads through wall B"):
                load_scenario("turn.yaml")


def test_numbers_of_a_path_may_be_drawn_and_a_drawn_place_moves_the_path(here, scenario_text):
    motion = "{repeat: back_and_forth, waypoints: [{t_s: {uniform: [2, 3]}, offset: [{uniform: [0.1, 0.2]}, 0]}]}"
    (here / "drawn.yaml").write_text(scenario(scenario_text, motion, center="[0.1, {uniform: [-0.1, 0.1]}]"))
    loaded = load_scenario("drawn.yaml")
    paths = [draw_run(loaded, "CW", run).arena.obstacles[1] for run in (1, 2)]
    times = [path.motion.waypoints[0].t_s for path in paths]
    assert times[0] != times[1]
    assert all(2 <= time_s <= 3 for time_s in times)
    assert "arena.obstacles.1.motion.waypoints.0.offset.0" in draw_run(loaded, "CW", 1).drawn


@pytest.mark.usefixtures("here")
def test_an_obstacle_that_stands_still_says_nothing_of_motion():
    loaded = load_scenario("trial.yaml")
    spec = draw_run(loaded, "CW", 1)
    assert '"motion"' not in spec.model_dump_json()
    assert "motion" not in str(loaded.tree["arena"]["obstacles"])


def test_a_path_is_taken_away_by_null(here, scenario_text):
    moving = "{waypoints: [{t_s: 5, offset: [0.1, 0]}]}"
    (here / "moving.yaml").write_text(scenario(scenario_text, moving))
    still = draw_run(load_scenario("moving.yaml", ["arena.obstacles.1.motion=null"]), "CW", 1)
    assert still.arena.obstacles[1].motion is None
