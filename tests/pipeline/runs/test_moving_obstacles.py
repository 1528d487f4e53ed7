"""Moving obstacles from the scenario to the release: laps, tables, images, what verify and rerender make of them."""

import itertools
import json

import numpy as np
import pytest

from blender_scenes.render.job_file import job_path, read_job
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main
from pipeline.stages.simulate import simulate
from symolo.arena.footprints import Rectangle, overlap
from symolo.arena.geometry import Arena
from symolo.verification.verify import verify
from tests.release_fixtures import ONE_ROUTE

SHORT = ["--set=stop.lap=false", f"--set={ONE_ROUTE}"]
TABLE = "CW/test_1/side/obstacles.csv"


@pytest.fixture(scope="module")
def moving(tmp_path_factory, tiny, in_this_process):
    """A second of one run, its images painted; read only."""
    out = tmp_path_factory.mktemp("moving") / "data"
    with in_this_process():
        assert main(["release", "moving", "--out", str(out), *tiny, *SHORT]) == 0
    return out


STATES = {"CW": [0, 1, 5, 1, 2, 4, 2, 0, 5, 0], "CCW": [0, 5, 0, 1, 3, 1, 2, 6, 2, 0]}


@pytest.fixture(scope="module")
def laps(begun):
    """Specification, its run, and that without the moving obstacles, by route."""
    found = {}
    for route in STATES:
        spec = draw_run(load_scenario("moving"), route, 1)
        still = spec.arena.model_copy(update={"obstacles": spec.arena.obstacles[:2]})
        found[route] = spec, begun(spec), begun(spec.model_copy(update={"arena": still}))
    return found


@pytest.mark.parametrize("route", STATES)
def test_the_shipped_lap_goes_past_both_obstacles_and_sees_them(route, laps):
    spec, run, undisturbed = laps[route]
    outcome = run.result()
    assert outcome.problems == ()
    trajectory = outcome.recording.trajectory
    assert [state for state, _ in itertools.groupby(trajectory.state.tolist())] == STATES[route]
    arena = Arena.from_config(spec.arena)
    chassis = spec.robot.chassis
    for box in arena.moving:
        series = outcome.recording[f"obstacle_{box.name}"]
        assert series.unit == "m, m, rad"
        for robot, (x, y, yaw) in zip(trajectory.pose, series.values, strict=True):
            body = Rectangle(tuple(robot[:2]), (chassis.length_m, chassis.width_m), robot[2])
            assert not overlap(body, Rectangle((x, y), box.size[:2], yaw))
    without = undisturbed.result().recording["tof_m"].values
    rows = min(len(without), len(trajectory.t_s))
    shorter = outcome.recording["tof_m"].values[:rows] < without[:rows] - 0.1
    assert np.all(shorter.sum(axis=0) > 10)  # half a second in each of the three sensors


def test_a_box_that_drives_into_the_robot_ends_the_run_by_its_name():
    ram = "{name: Ram, center: [1.0, -0.5], motion: {waypoints: [{t_s: 2, offset: [-0.5, 0.0]}]}}"
    outcome = simulate(draw_run(load_scenario("smoke", [f"arena.obstacles=[{ram}]"]), "CW", 1))
    (problem,) = outcome.problems
    assert problem.startswith("touched Ram at ")


def test_the_table_follows_the_path_at_every_row(moving):
    header, *rows = (line.split(",") for line in (moving / TABLE).read_text().splitlines())
    assert header == ["t", *(f"{name}_{field}" for name in ("Crosser", "Patrol") for field in ("x", "y", "theta"))]
    table = np.array(rows, dtype=float)
    t_s = np.arange(21) / 20
    np.testing.assert_array_equal(table[:, 0], 1000 * t_s)
    # By configs/arenas/moving.yaml: 0.75 m and a quarter turn in 1.5 s; half a second's rest, then 0.75 m in 4 s.
    crosser = np.stack([0.95 - 0.5 * t_s, np.full(21, -0.75), 0.5 * np.pi * t_s / 1.5], axis=1)
    patrol = np.stack([0.35 - 0.1875 * np.maximum(t_s - 0.5, 0.0), np.full(21, -1.38), np.zeros(21)], axis=1)
    np.testing.assert_allclose(table[:, 1:], np.hstack([crosser, patrol]), atol=5.1e-7)
    columns = json.loads((moving / "metadata.json").read_text())["columns"]["side/obstacles.csv"]
    assert [column["name"] for column in columns] == header
    description = (moving / "README.md").read_text()
    assert "obstacles.csv" in description
    assert "(0.95, -0.75) at t = 0, moves" in description


def test_a_dataset_in_which_nothing_moves_has_no_such_table(dataset):
    assert not (dataset / TABLE).exists()
    assert "side/obstacles.csv" not in json.loads((dataset / "metadata.json").read_text())["columns"]


@pytest.mark.long
def test_rerender_puts_the_obstacles_where_they_were_with_more_workers_too(tmp_path, tiny, symolo):
    root, out = tmp_path / "data", tmp_path / "again"
    run = root / "CW/test_1"
    assert symolo("release", "moving", "--out", root, *tiny, *SHORT, "--workers", 1).code == 0
    assert symolo("rerender", run, "--look", "classroom", "--out", out, "--workers", 2).code == 0
    for number in range(1, 7):
        name = f"images/{number:06d}.jpg"
        assert (out / "CW/test_1" / name).read_bytes() == (run / name).read_bytes(), name
    assert (out / TABLE).read_bytes() == (root / TABLE).read_bytes()
    assert list(verify(out)) == []
    frames = json.loads(read_job(job_path(out / ".stages/render/CW/test_1")))["frames"]
    np.testing.assert_allclose([frame["moving"][0][0] for frame in frames], 0.95 - 0.5 * 0.2 * np.arange(6))


DAMAGE = {
    "a place off the path": (lambda text: text.replace("0.850000", "0.851000", 1), "Crosser is not where its path"),
    "another header": (lambda text: text.replace("Patrol_x", "Patrol_z"), "Patrol_z is not known"),
    "another time": (lambda text: text.replace("\n50,", "\n51,"), "column t is not that of data.csv"),
}


def test_verify_finds_no_fault_in_it(moving):
    assert list(verify(moving)) == []


@pytest.mark.parametrize("kind", DAMAGE)
def test_verify_finds_damage_of_the_table(kind, moving, copy_of, sign):
    change, telling = DAMAGE[kind]
    root = copy_of(moving)
    text = (root / TABLE).read_text()
    assert change(text) != text
    (root / TABLE).write_text(change(text))
    sign(root)
    findings = [str(finding) for finding in verify(root)]
    assert len(findings) == 1
    assert findings[0].startswith(TABLE)
    assert telling in findings[0]


def test_verify_misses_the_table(moving, copy_of, sign):
    root = copy_of(moving)
    (root / TABLE).unlink()
    sign(root)
    assert [str(finding) for finding in verify(root)] == [f"{TABLE}: cannot be read: No such file or directory"]
