"""The page that plays runs: what it holds, and that it fetches and runs nothing but its own script."""

import base64
import hashlib
import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from symolo.core.progress import LineReport
from symolo.reader.dataset import load
from symolo.view.page import ViewLimits, view_page

LIMITS = ViewLimits(max_runs=12, max_images=1500, max_width_px=320)


def data_of(html):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', html, re.DOTALL).group(1))


def words(html):
    return " ".join(re.sub(r"<script.*?</script>|<[^>]*>", " ", html.partition("<body>")[2], flags=re.DOTALL).split())


@pytest.fixture(scope="module")
def root(painted):
    return painted()


@pytest.fixture(scope="module")
def page(root):
    return view_page(load(root), LIMITS, LineReport()).html.decode()


def test_rows_and_images_are_those_of_the_release(root, page):
    runs = data_of(page)["runs"]
    assert [run["name"] for run in runs] == ["CW/test_1", "CW/test_2", "CCW/test_1"]
    first = runs[0]
    # The drive of the fixture: 41 rows at 20 Hz, 10 mm each down the straight at x = 0.55 m, then at 0.58 m.
    assert first["t"] == pytest.approx(0.05 * np.arange(41))
    assert first["pose"]["x"] == pytest.approx([0.55] * 20 + [0.58] * 21)
    assert first["pose"]["y"] == pytest.approx(-0.20 - 0.01 * np.arange(41))
    assert first["state"] == [0] * 20 + [5] * 12 + [0] * 9
    (camera,) = first["cameras"]
    assert camera["t"] == pytest.approx(0.2 * np.arange(11))
    for number, jpeg in zip(camera["number"], camera["jpeg"], strict=True):
        assert base64.b64decode(jpeg) == (root / f"CW/test_1/images/{number:06d}.jpg").read_bytes()


def test_a_range_on_the_map_has_the_colour_of_its_curve(root, monkeypatch):
    dataset = load(root)
    run = dataset.runs[0]
    seen = replace(run.table, tof_m=np.tile([2.0, 0.5, 0.6], (41, 1)))
    monkeypatch.setattr(type(run), "table", seen)
    shown = data_of(view_page(dataset, LIMITS, LineReport()).html.decode())["runs"][0]
    (ranges,) = (plot for plot in shown["plots"] if plot["title"] == "range")
    curves = {curve["name"]: curve["colour"] for curve in ranges["curves"]}
    beams = {beam["name"]: beam["colour"] for beam in shown["beams"]}
    assert beams == {"d_l": curves["left"], "d_r": curves["right"]}, "the sensor ahead saw nothing"
    assert curves["left"] != curves["right"]


def test_plots_are_those_of_the_columns(page):
    plots = {plot["title"]: plot for plot in data_of(page)["runs"][0]["plots"]}
    assert plots["forward speed v"]["curves"][0]["values"] == [0.2] * 41
    assert [curve["name"] for curve in plots["range"]["curves"]] == ["front", "left", "right"]
    assert plots["range"]["curves"][0]["values"] == [None] * 41, "2.0 m stands for no target"
    line = plots["line sensor"]
    assert base64.b64decode(line["levels"]) == bytes([round(0.9 * 255)]) * (41 * 8)
    assert (line["rows"], line["channels"], line["names"][0]) == (41, 8, "L0")


def test_the_policy_allows_the_script_of_the_page_and_nothing_else(page):
    tree = ET.fromstring(page.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    (policy,) = (meta for meta in tree.iter("meta") if meta.get("http-equiv") == "Content-Security-Policy")
    allowed = dict(part.strip().split(" ", 1) for part in policy.attrib["content"].split(";"))
    assert (allowed["default-src"], allowed["img-src"]) == ("'none'", "data:")
    script = re.search(r"<script>(.*?)</script>", page, re.DOTALL).group(1)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert allowed["script-src"] == f"'sha256-{digest}'"
    assert [element.get("type") for element in tree.iter("script")] == ["application/json", None]
    assert not [name for element in tree.iter() for name in element.attrib if name in {"src", "href"}]


def test_markup_in_a_name_is_text(painted):
    data = load(painted())
    hostile = "</script><script>alert(1)</script>"
    metadata = data.metadata.model_copy(update={"name": hostile})
    runs = tuple(type(run)(run.folder, hostile, run.sensor_tables) for run in data.runs[:1])
    html = view_page(type(data)(data.root, metadata, runs), LIMITS, LineReport()).html.decode()
    assert data_of(html)["runs"][0]["name"] == hostile
    assert html.count("<script") == 2
    ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page


def test_of_many_runs_and_images_some_are_shown_and_the_page_says_so(root):
    made = view_page(load(root), ViewLimits(max_runs=2, max_images=8, max_width_px=24), LineReport())
    page = made.html.decode()
    runs = data_of(page)["runs"]
    assert [run["name"] for run in runs] == ["CW/test_1", "CCW/test_1"]
    assert [run["cameras"][0]["number"] for run in runs] == [[1, 4, 8, 11]] * 2, "the first and the last among them"
    assert (made.runs, made.images) == (2, 8)
    assert "2 of 3 runs are on this page" in words(page)
    assert "8 of 22 images are on this page" in words(page)
    for jpeg in runs[0]["cameras"][0]["jpeg"]:
        header = base64.b64decode(jpeg)
        frame = header.index(b"\xff\xc0")  # SOF0 of JPEG: length, precision, height, width
        assert header[frame + 5 : frame + 9] == bytes([0, 16, 0, 24])


def test_an_arena_with_moving_obstacles_has_their_pose_at_each_row(painted):
    html = view_page(load(painted(settings=["arena=moving"])), LIMITS, LineReport()).html.decode()
    boxes = {box["name"]: box for box in data_of(html)["runs"][0]["arena"]["boxes"]}
    crosser = boxes["Crosser"]
    assert len(boxes["O1"]["x"]) == 1
    # configs/arenas/moving.yaml: 0.75 m towards -x and a quarter turn in 1.5 s, which are 30 rows.
    assert [crosser["x"][row] - crosser["x"][0] for row in (15, 30, 40)] == pytest.approx([-0.375, -0.75, -0.75])
    assert crosser["theta"][40] - crosser["theta"][0] == pytest.approx(np.pi / 2, abs=1e-3)


def test_a_sonar_is_drawn_on_the_map_and_in_the_plot_of_the_ranges(tmp_path, symolo):
    """It hangs at the back and looks backwards; each row has its last reading, and none for an echo that is missed."""
    robot = tmp_path / "robot.yaml"
    mount = "kind: ultrasonic, x_m: -0.07, yaw_deg: 180, period_s: 0.06, dropout_probability: 0.5"
    robot.write_text(f"extends: nominal\nname: sensing\nsensors: {{rear_sonar: {{{mount}}}}}\n")
    settings = ("--set", f"robot={robot}", "--set", "stop.time_limit_s=1", "--workers", 1)
    assert symolo("simulate", "smoke", *settings, "--out", tmp_path / "data").code == 0
    assert symolo("view", tmp_path / "data", "--out", tmp_path / "view.html", "--runs", "CW/*").code == 0
    (run,) = data_of((tmp_path / "view.html").read_text())["runs"]
    beam = next(beam for beam in run["beams"] if beam["name"] == "rear_sonar")
    assert (beam["x"], beam["y"], beam["yaw"]) == (-0.07, 0.0, pytest.approx(np.pi))
    with np.load(tmp_path / "data/.stages/simulate/CW/test_1/trajectory.npz") as stored:
        times_s, ranges_m = (stored[f"series/sensor_rear_sonar/m/{name}"].ravel() for name in ("t_s", "values"))
    readings = [*zip(times_s.tolist(), ranges_m.tolist(), strict=True)]
    expected = []
    for row in range(len(run["pose"]["x"])):
        before = [range_m for t_s, range_m in readings if t_s <= 0.05 * row + 1e-6]
        expected.append(before[-1] if before and before[-1] > 0 else None)
    assert beam["range"] == [value if value is None else pytest.approx(value, abs=1e-3) for value in expected]
    assert {None} < {*expected}
    plot = next(plot for plot in run["plots"] if plot["title"] == "range")
    colours = {curve["name"]: curve["colour"] for curve in plot["curves"]}
    assert [*colours] == ["front", "left", "right", "rear sonar"]
    assert colours["rear sonar"] == beam["colour"]


def test_further_sensors_have_plots_and_scans_lie_on_the_walls(tmp_path, symolo):
    """A simulated run with IMU and lidar: the ends of the rays, from the pose at the time of the scan."""
    robot = tmp_path / "robot.yaml"
    sensors = "{imu: {period_s: 0.01}, lidar: {rays: 90, ray_step_deg: 4, sweep_s: 0, noise_m: 0, noise_share: 0}}"
    robot.write_text(f"extends: nominal\nname: sensing\nsensors: {sensors}\n")
    settings = ("--set", f"robot={robot}", "--set", "stop.time_limit_s=0.5", "--workers", 1)
    assert symolo("simulate", "smoke", *settings, "--out", tmp_path / "data").code == 0
    out = tmp_path / "view.html"
    assert symolo("view", tmp_path / "data", "--out", out, "--runs", "CW/*").code == 0
    (run,) = data_of(out.read_text())["runs"]
    plots = {plot["title"]: plot for plot in run["plots"]}
    assert [len(plots[name]["t"]) for name in ("imu", "lidar range")] == [51, 6]
    assert (plots["lidar range"]["channels"], plots["lidar range"]["names"][-1]) == (90, "89")
    (scan,) = run["scans"]
    ranges_m = np.frombuffer(base64.b64decode(scan["mm"]), "<u2").reshape(6, 90)[0] / 1000
    seen = ranges_m > 0
    x, y, theta = (run["pose"][name][0] for name in ("x", "y", "theta"))
    angles = theta + np.array(scan["angles"])[seen]
    ends = np.array([x, y]) + ranges_m[seen, None] * np.column_stack((np.cos(angles), np.sin(angles)))
    # Wall B of the arena has its face from (-0.49, 0.30) to (-0.52, -0.72) and faces the robot with its other side.
    along = np.array([-0.03, -1.02]) / np.hypot(0.03, 1.02)
    across = (ends - [-0.49, 0.30]) @ np.array([-along[1], along[0]])
    on_b = (np.abs((ends - [-0.49, 0.30]) @ along - 0.51) < 0.45) & (np.abs(across) < 0.1)
    assert on_b.sum() >= 5
    assert np.abs(np.abs(across[on_b]) - 0.01).max() < 0.02


def test_the_same_runs_give_the_same_bytes(root, page):
    assert view_page(load(root), LIMITS, LineReport()).html.decode() == page
