"""Random arenas: closed and smooth by closed form, with room by brute force, drawn by seed alone."""

import contextlib
import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from configs.arena_generation import clearance
from configs.arena_generation.generate import generate_arena
from configs.arena_generation.outline import START_AHEAD_M, START_BEHIND_M, draw_outline, rounded
from configs.arena_generation.rejection import Rejected
from configs.arena_generation.site import NOTICED_M, Site
from configs.arena_generation.track import Segment, Track
from configs.draw import draw_arena, draw_robot, draw_run
from configs.loader import load_scenario, load_section
from configs.schema.arena import ArenaConfig, LineConfig, Obstacle, StraightPiece, WallConfig
from configs.schema.arena_generator import ArenaGenerator, Clearance
from physics.run.lap import LapDetector
from symolo.arena.footprints import obstacle_footprint, wall_footprint
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.core.random_streams import stream

SEEDS = range(200)
ROBOT_HALF_DIAGONAL_M = math.hypot(0.09, 0.085)


@pytest.fixture(scope="module")
def recipe():
    return load_section("arena", "random")


@pytest.fixture(scope="module")
def nominal():
    return draw_robot(load_section("robot", "nominal"), 1)[0]


@pytest.fixture(scope="module")
def arenas(recipe):
    return [draw_arena(recipe, seed, "Lap", 1)[0] for seed in SEEDS]


def sampled(arena, spacing_m=0.01):
    """Points (N, 2) and headings (N,) along the line, by the arena's own pieces."""
    points, yaws = [], []
    for piece in Arena.from_config(arena).line.pieces:
        s = np.linspace(0.0, piece.length_m, max(2, round(piece.length_m / spacing_m)), endpoint=False)
        ahead = piece.at(s + 1e-6) - piece.at(s)
        points.append(piece.at(s))
        yaws.append(np.arctan2(ahead[:, 1], ahead[:, 0]))
    return np.concatenate(points), np.concatenate(yaws)


def edge_points(rectangle, spacing_m=0.03):
    corners = np.array(rectangle.corners())
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    return np.concatenate([np.linspace(a, b, 2 + int(math.dist(a, b) / spacing_m)) for a, b in sides])


def test_every_line_is_closed_and_turns_once_without_a_corner(arenas):
    for arena in arenas:
        ends, turned = [], 0.0
        for piece in arena.line.pieces:
            if isinstance(piece, StraightPiece):
                along = np.subtract(piece.end, piece.start)
                yaw = math.atan2(along[1], along[0])
                ends.append((piece.start, yaw, piece.end, yaw))
                continue
            start, end = math.radians(piece.start_deg), math.radians(piece.end_deg)
            sign = math.copysign(1.0, end - start)
            turned += end - start
            on = [
                np.add(piece.center, (piece.radius_m * math.cos(a), piece.radius_m * math.sin(a))) for a in (start, end)
            ]
            ends.append((on[0], start + sign * math.pi / 2, on[1], end + sign * math.pi / 2))
        for (_, _, end, end_yaw), (begin, begin_yaw, _, _) in zip(ends, ends[1:] + ends[:1], strict=True):
            assert end == pytest.approx(begin, abs=1e-9)
            assert math.remainder(end_yaw - begin_yaw, 2 * math.pi) == pytest.approx(0, abs=1e-9)
        assert abs(turned) == pytest.approx(2 * math.pi)


def test_both_directions_and_several_shapes_occur(arenas):
    turned = [
        sum(p.end_deg - p.start_deg for p in arena.line.pieces if not isinstance(p, StraightPiece)) for arena in arenas
    ]
    assert min(sum(t > 0 for t in turned), sum(t < 0 for t in turned)) > 60
    assert {len(arena.line.pieces) for arena in arenas} == {6, 8, 10, 12}
    assert {len(arena.walls) for arena in arenas} == {4, 5, 6, 7}
    counts = [sum(o.name.startswith("Obstacle") for o in arena.obstacles) for arena in arenas]
    assert set(counts) == {1, 2, 3}
    assert any(o.name.startswith("Decoy") for arena in arenas for o in arena.obstacles)


@pytest.mark.parametrize("clockwise", [False, True])
def test_the_robot_goes_round_as_it_is_commanded(clockwise):
    """Also round a triangle whose corners are all seen from its middle within half a turn."""
    recipe, rng = ArenaGenerator(clockwise=clockwise, corners=3, radius_m=20, irregularity=0.9), stream(1, "outlines")
    for _ in range(1000):
        with contextlib.suppress(Rejected):
            track = draw_outline(recipe, (0.0, 0.0, 0.0), rng)
            turned = track.begins[-1][2] - track.begin[2]
            assert turned == pytest.approx(-2 * math.pi if clockwise else 2 * math.pi)


def test_the_line_passes_the_origin_straight_on(arenas):
    for arena in arenas:
        first = arena.line.pieces[0]
        assert isinstance(first, StraightPiece)
        assert first.start[1] == pytest.approx(0, abs=1e-12)
        assert first.end[1] == pytest.approx(0, abs=1e-12)
        assert first.start[0] <= -0.2 + 1e-9
        assert first.end[0] >= 0.45 - 1e-9


def test_the_line_passes_the_start_that_is_given_and_otherwise_the_origin_along_x(recipe):
    plain = draw_arena(recipe, 0, "Lap", 1)[0].line.pieces[0]
    moved = draw_arena(recipe, 0, "Lap", 1, start=(0.5, 1.0, math.pi / 2))[0].line.pieces[0]
    assert isinstance(plain, StraightPiece)
    assert isinstance(moved, StraightPiece)
    assert (plain.start[1], plain.end[1]) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert plain.start[0] < 0.0 < plain.end[0]
    assert (moved.start[0], moved.end[0]) == pytest.approx((0.5, 0.5))
    assert moved.start[1] < 1.0 < moved.end[1]


def test_nothing_but_obstacles_stands_in_reach_of_the_robot_or_ahead_of_it(arenas):
    """Every point of a wall and decoy from every place on the line, one by one."""
    limits = Clearance()
    for arena in arenas:
        points, yaws = sampled(arena, 0.04)
        decoys = [obstacle_footprint(o) for o in arena.obstacles if o.name.startswith("Decoy")]
        solid = np.concatenate([edge_points(r) for r in [wall_footprint(w) for w in arena.walls] + decoys])
        assert cdist(solid, points).min() > limits.beside_m - 0.005
        sensor = points + 0.085 * np.stack([np.cos(yaws), np.sin(yaws)], axis=1)
        solid_at, line_at = np.nonzero(cdist(solid, sensor) <= limits.ahead_m - 0.02)
        dx, dy = (solid[solid_at] - sensor[line_at]).T
        bearing = np.arctan2(dy, dx)
        off_axis = np.abs(np.angle(np.exp(1j * (bearing - yaws[line_at]))))
        assert off_axis.min(initial=np.inf) >= math.radians(20)


def test_no_two_stretches_of_line_come_near_each_other(arenas):
    limit_m = Clearance().stretches_m
    for arena in arenas:
        points, _ = sampled(arena, 0.04)
        along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        apart_along = np.abs(along[:, None] - along)
        apart_along = np.minimum(apart_along, along[-1] - apart_along)
        assert cdist(points, points)[apart_along > 0.5].min() > limit_m - 0.04


def test_every_obstacle_has_floor_to_pass_it_on_one_side(arenas):
    """The stored path with the robot's half diagonal around it meets neither wall nor box."""
    x = np.linspace(0, 0.68, 69)
    share = np.select([x < 0.26, x < 0.42], [x / 0.26, 1.0], (0.68 - x) / 0.26)
    aside = 0.19 * (3 * share**2 - 2 * share**3)
    for arena in arenas:
        points, yaws = sampled(arena, 0.01)
        for obstacle in [o for o in arena.obstacles if o.name.startswith("Obstacle")]:
            nearest = int(np.argmin(np.hypot(*(points - obstacle.center).T)))
            others = [obstacle_footprint(o) for o in arena.obstacles if o is not obstacle]
            others += [wall_footprint(w) for w in arena.walls]
            solid = np.concatenate([edge_points(rectangle) for rectangle in others])
            along = np.array([np.cos(yaws[nearest]), np.sin(yaws[nearest])])
            left = np.array([-along[1], along[0]])
            begin_m = -0.285 - 0.5 * max(obstacle.size[:2])
            rooms = []
            for side in (1.0, -1.0):
                path = points[nearest] + np.outer(x + begin_m, along) + side * np.outer(aside, left)
                rooms.append(cdist(solid, path).min())
            assert max(rooms) > ROBOT_HALF_DIAGONAL_M


def test_the_same_seed_gives_the_same_arena_and_another_field_does_not_change_it():
    plain = draw_run(load_scenario("random_arenas"), "Lap", 1)
    again = draw_run(load_scenario("random_arenas"), "Lap", 1)
    assert plain.model_dump_json() == again.model_dump_json()
    settings = ("robot.chassis.mass_kg={uniform: [0.8, 1.0]}", "routes.0.start.x_m={uniform: [-0.02, 0.02]}")
    other = draw_run(load_scenario("random_arenas", settings), "Lap", 1)
    assert other.start.x_m != plain.start.x_m
    assert other.arena == plain.arena
    assert draw_run(load_scenario("random_arenas"), "Lap", 2).arena != plain.arena


def test_the_specification_holds_the_arena_and_no_recipe():
    spec = draw_run(load_scenario("random_arenas"), "Lap", 3)
    stored = json.loads(spec.model_dump_json())["arena"]
    assert "generate" not in stored
    assert len(stored["line"]["pieces"]) >= 6
    assert spec.drawn["arena.generate.corners"] * 2 == len(stored["line"]["pieces"])
    assert ArenaConfig.model_validate_json(json.dumps(stored)) == spec.arena


@pytest.mark.parametrize(("yaw_deg", "around_deg"), [(0, [-9, 9]), (90, [80, 100]), (-135, [-137, -133])])
def test_the_line_lies_where_the_route_starts_whatever_the_scenario(yaw_deg, around_deg):
    """In the middle of what its start is drawn from, and the run starts off the line by what was drawn."""
    ranges = f"x_m: {{uniform: [0.9, 1.1]}}, y_m: {{normal: [-0.5, 0.01]}}, yaw_deg: {{uniform: {around_deg}}}"
    loaded = load_scenario("random_arenas", [f"routes=[{{name: A, start: {{{ranges}}}}}]"])
    spec = draw_run(loaded, "A", 1)
    first = spec.arena.line.pieces[0]
    assert isinstance(first, StraightPiece)
    assert abs(spec.start.yaw_deg - yaw_deg) > 0.1
    along = np.subtract(first.end, first.start)
    assert math.atan2(along[1], along[0]) == pytest.approx(math.radians(yaw_deg))
    to_start = np.subtract((1.0, -0.5), first.start)
    assert along[0] * to_start[1] - along[1] * to_start[0] == pytest.approx(0, abs=1e-9)


def test_the_line_passes_a_start_that_is_one_of_several_places_and_not_between_them():
    start = "{x_m: 0.0, y_m: {choice: [-0.5, 0.5]}, yaw_deg: 0}"
    overrides = [f"routes=[{{name: A, start: {start}}}]", "arena.generate.corners={choice: [4]}"]
    spec = draw_run(load_scenario("random_arenas", overrides), "A", 1)
    first = spec.arena.line.pieces[0]
    assert isinstance(first, StraightPiece)
    assert spec.start.y_m in {-0.5, 0.5}
    assert (first.start[1], first.end[1]) == pytest.approx((spec.start.y_m, spec.start.y_m))


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("max_bend_radius_m=0.1", r"arena\.generate\.min_bend_radius_m: got 0\.22, allowed: at most max_bend"),
        ("min_obstacle_m=0.5", r"arena\.generate\.min_obstacle_m: got 0\.5, allowed: at most max_obstacle_m"),
        ("min_obstacles=4", r"arena\.generate\.min_obstacles: got 4, allowed: at most max_obstacles, which is 1"),
        ("walls=2", r"arena\.generate\.walls: got 2, allowed: 0, or 3 or more"),
        ("corners=2", r"arena\.generate\.corners: got 2, allowed: whole number >= 3"),
        ("corners={uniform: [5, 3]}", r"arena\.generate\.corners"),
        ("clearance.stretches_m=1.0", r"min_bend_radius_m: got 0\.22, allowed: at least half of clearance"),
        ("max_decoy_distance_m=0.1", r"max_decoy_distance_m: got 0\.1, allowed: at least clearance\.beside_m"),
        ("max_bend_radius_m=5.1", r"arena\.generate\.max_bend_radius_m: got 5\.1, allowed: number .*<= 5"),
        ("cornes=4", r"arena\.generate\.cornes: unknown key.*did you mean corners"),
        ("surfaces=[woood]", r"surfaces.*did you mean wood"),
        ("surfaces=[]", r"arena\.generate\.surfaces"),
    ],
)
def test_ranges_that_make_no_sense_are_refused(setting, message):
    with pytest.raises(InputError, match=message) as refusal:
        load_scenario("random_arenas", [f"arena.generate.{setting}"])
    assert len(str(refusal.value).splitlines()) == 1


def test_ranges_for_which_no_arena_fits_are_refused_with_the_reason():
    loaded = load_scenario("random_arenas", ["arena.generate.radius_m=0.3", "arena.generate.corners=12"])
    message = r"generate: none of 200 attempts at an arena succeeded; \d+ of them failed because .*drawn for Lap run 1"
    with pytest.raises(InputError, match=message):
        draw_run(loaded, "Lap", 1)


def test_a_floor_that_is_too_small_is_refused():
    loaded = load_scenario("random_arenas", ["arena.floor.half_extent_m=0.6"])
    with pytest.raises(InputError, match="because the line or a wall reaches beyond the floor"):
        draw_run(loaded, "Lap", 1)


@pytest.mark.parametrize(
    ("half_extent_m", "settings"),
    [
        (4.0, ["walls=3"]),  # two sides of a triangle may meet very far away
        (2.2, ["walls=0", "max_decoys=20"]),
        (2.4, ["walls=0", "irregularity=0.9", "corners=6", "min_obstacles=0"]),  # bends that lean outwards
    ],
)
def test_all_that_is_drawn_stands_on_the_floor_or_another_attempt_is_made(half_extent_m, settings):
    loaded = load_scenario(
        "random_arenas",
        [f"arena.floor.half_extent_m={half_extent_m}", *(f"arena.generate.{setting}" for setting in settings)],
    )
    for run in range(1, 13):
        spec = draw_run(loaded, "Lap", run)
        arena = Arena.from_config(spec.arena)
        tape = np.concatenate([edge for edges in arena.line.edges() for edge in edges])
        boxes = [obstacle_footprint(obstacle).corners() for obstacle in spec.arena.obstacles]
        faces = [(wall.start, wall.end) for wall in spec.arena.walls]
        assert np.abs(np.concatenate([tape, *boxes, *faces])).max() < half_extent_m


def test_a_recipe_and_a_line_of_its_own_do_not_go_together():
    with pytest.raises(InputError, match=re.escape("arena.walls: 4 of them beside arena.generate")):
        load_scenario("classroom", ["arena.generate={corners: 4}", "arena.line.pieces=[]", "arena.obstacles=[]"])


def test_an_arena_without_a_recipe_is_left_alone():
    arena = ArenaConfig(name="plain", line=LineConfig())
    assert generate_arena(arena, (0.0, 0.0, 0.0), stream(1, "x")) is arena


def test_an_arc_in_a_right_angle_takes_its_radius_of_either_edge():
    """tan 45 degrees is 1: a square of 2 m with bends of 0.3 m has straights of 1.4 m and quarter circles."""
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    track = rounded(square, ArenaGenerator(min_bend_radius_m=0.3, max_bend_radius_m=0.3), stream(1, "x"))
    assert track.begin == pytest.approx((0.3, 0.0, 0.0))
    assert [s.length_m for s in track.segments] == pytest.approx([1.4, 0.15 * math.pi] * 4)
    assert track.begins[-1] == pytest.approx((0.3, 0.0, 2 * math.pi))


def test_poses_along_an_arc_lie_on_its_circle():
    track = Track((1.0, 2.0, 0.5), (Segment(0.4, 0.0), Segment(1.0, -2.0)))
    pose = track.poses(np.array([0.4 + 0.25 * math.pi]))[0]
    # A quarter circle of 0.5 m to the right: half a metre on and half a metre to the right.
    c, s = math.cos(0.5), math.sin(0.5)
    assert pose == pytest.approx((1.0 + 0.9 * c + 0.5 * s, 2.0 + 0.9 * s - 0.5 * c, 0.5 - math.pi / 2))


def test_sensors_stand_where_robot_nominal_has_them(nominal):
    mounts = nominal.tof.mounts
    for there, mount in (
        (clearance.FRONT_SENSOR, mounts.front),
        (clearance.LEFT_SENSOR, mounts.left),
        (clearance.RIGHT_SENSOR, mounts.right),
    ):
        assert there == (mount.x_m, mount.y_m, math.radians(mount.yaw_deg))
    assert math.radians(0.5 * nominal.tof.field_of_view_deg) == clearance.HALF_FIELD_RAD


def test_the_room_that_is_kept_is_more_than_robot_nominal_takes(nominal):
    limits, chassis, avoidance = Clearance(), nominal.chassis, nominal.controller.avoidance
    assert limits.stretches_m > 3 * (nominal.line_sensor.channels - 1) * nominal.line_sensor.pitch_m
    assert limits.beside_m > math.hypot(0.5 * chassis.length_m, 0.5 * chassis.width_m)
    assert limits.ahead_m > avoidance.front_below_m
    assert limits.passing_m > avoidance.side_m + math.hypot(0.5 * chassis.length_m, 0.5 * chassis.width_m)
    assert limits.other_side_m > 0.5 * math.hypot(chassis.length_m, chassis.width_m)
    assert limits.obstacle_reach_m < avoidance.side_m - 0.5 * chassis.width_m
    assert limits.blocked_side_m < avoidance.free_side_beyond_m < limits.free_side_m
    noticed_m = avoidance.front_below_m + nominal.tof.mounts.front.x_m
    assert min(NOTICED_M) < noticed_m < max(NOTICED_M)
    before_m = noticed_m + 0.5 * ArenaGenerator().max_obstacle_m
    assert limits.before_m > before_m
    assert limits.regained_side_m > nominal.controller.wall.found_within_m
    assert limits.after_m > avoidance.out_length_m + avoidance.along_length_m + avoidance.back_length_m - before_m


def test_the_straight_line_about_the_start_holds_the_robot_and_the_window_of_the_lap(nominal):
    assert 0.5 * nominal.chassis.length_m < START_BEHIND_M
    assert LapDetector((0.0, 0.0, 0.0)).window_m < START_AHEAD_M


@pytest.mark.parametrize(("min_m", "near"), [(0.15, False), (0.195, False), (0.205, True), (0.25, True)])
def test_a_line_comes_as_near_itself_as_two_straights_are_apart(min_m, near):
    """Half circles of 0.1 m join straights of 1 m; they are 0.2 m apart."""
    narrow = Track((0.0, 0.0, 0.0), (Segment(1.0, 0.0), Segment(0.1 * math.pi, 10.0)) * 2)
    points = narrow.poses(np.linspace(0.0, narrow.length_m, 260, endpoint=False))[:, :2]
    assert clearance.comes_near_itself(points, narrow.length_m / 260, min_m) is near


STADIUM = Track((-1.0, 0.0, 0.0), tuple(Segment(2.0, 0.0) if i % 2 == 0 else Segment(math.pi, 1.0) for i in range(4)))
FLOOR_M = 4.0
CUBE = Obstacle(name="Cube", center=(0.2, 0.0), size=(0.08, 0.08, 0.12))


def stadium(*walls):
    return Site(replace(STADIUM, start_m=4.0 + math.pi), walls, FLOOR_M, Clearance())


@pytest.mark.parametrize(
    ("center", "free"),
    [
        ((0.3, 0.25), False),  # on the way past the obstacle
        ((0.25, 0.40), False),  # where the left sensor looks before the robot turns out
        ((0.6, 0.45), True),
        ((0.1, -0.30), True),
    ],
)
def test_an_obstacle_on_a_long_straight_is_passed_on_the_left(center, free):
    site = stadium()
    assert site.put_obstacle(CUBE, 1.2)
    assert site.put_decoy(Obstacle(name="Decoy", center=center, size=(0.05, 0.05, 0.12))) is free


@pytest.mark.parametrize(
    ("center", "free"),
    [
        ((0.36, -0.34), False),  # swinging over the line behind the obstacle, the robot looks there
        ((0.36, 0.47), True),  # it comes from that side and looks away
        ((0.36, -0.52), True),
        ((0.70, -0.34), True),
    ],
)
def test_nothing_stands_where_the_robot_looks_when_it_meets_the_line_again(center, free):
    site = stadium()
    assert site.put_obstacle(CUBE, 1.2)
    assert site.put_decoy(Obstacle(name="Decoy", center=center, size=(0.05, 0.05, 0.12))) is free


def test_no_obstacle_is_put_where_something_stands_beside_the_way_back():
    beside = Obstacle(name="Decoy", center=(0.36, -0.34), size=(0.05, 0.05, 0.12))
    site = stadium()
    assert site.put_decoy(beside)
    assert not site.put_obstacle(CUBE, 1.2)


def test_an_obstacle_beside_a_wall_on_the_left_is_passed_on_the_right():
    wall = WallConfig(name="Near", start=(1.2, 0.205), end=(-1.2, 0.205))
    assert stadium(wall).put_obstacle(CUBE, 1.2)
    right_side_too = WallConfig(name="Right", start=(-1.2, -0.30), end=(1.2, -0.30))
    assert not stadium(wall, right_side_too).put_obstacle(CUBE, 1.2)


@pytest.mark.parametrize("at_m", [0.4, 1.5])
def test_an_obstacle_too_near_a_bend_is_not_put(at_m):
    """Of 2 m of straight line, 0.50 m are kept before it and 0.62 m behind."""
    cube = CUBE.model_copy(update={"center": (at_m - 1.0, 0.0)})
    assert not stadium().put_obstacle(cube, at_m)


@pytest.mark.parametrize(
    ("width_m", "turned_deg", "put"), [(0.19, 0, True), (0.21, 0, False), (0.13, 45, True), (0.15, 45, False)]
)
def test_an_obstacle_that_reaches_into_the_path_past_it_is_not_put(width_m, turned_deg, put):
    """0.10 m to either side is free of the path; 0.19 m wide it reaches 0.095 m, 0.15 m square and turned 0.106 m."""
    wide = CUBE.model_copy(update={"size": (width_m, width_m, 0.12), "yaw_deg": turned_deg})
    assert stadium().put_obstacle(wide, 1.2) is put


def test_an_obstacle_at_the_start_is_not_put():
    assert not Site(replace(STADIUM, start_m=1.0), (), FLOOR_M, Clearance()).put_obstacle(CUBE, 1.2)
