"""The page says what the release holds, stands alone, and is the same bytes for the same release."""

import base64
import re
import xml.etree.ElementTree as ET
from html import unescape

import pytest

from symolo.core.progress import LineReport
from symolo.dataset.documents.metadata import FailedRun
from symolo.reader.dataset import load
from symolo.report.camera_rows import camera_rows
from symolo.report.media import Media
from symolo.report.page import page
from symolo.report.plots.scans import scan_plot
from symolo.report.state_sheets import images_of_states
from symolo.report.statistics.facts import release_facts

HOSTILE = '<script src="https://example.org/x.js"></script>"\'&'


def text_page(root, max_detailed=12, maps=1):
    """The page without its plots, which take a second each."""
    data = load(root)
    facts = release_facts(data, data.metadata, max_detailed, LineReport())
    sheets = images_of_states(facts.runs)
    images = {(run.name, number): b"jpeg" for run in data for number in run.numbers}
    runs = dict.fromkeys(facts.detailed, b"svg")
    return page(facts, Media((b"svg",), maps, runs, sheets, images, b"svg", b"svg", min(3, len(facts.images))))


def words(html):
    """What a reader sees of it, spaces that do not break as others."""
    body = html.partition("<body>")[2]
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", body)).replace("\N{NO-BREAK SPACE}", " ").split())


@pytest.fixture(scope="module")
def whole(painted, tmp_path_factory):
    """A release, and its page as the command makes it."""
    from pipeline.cli import main  # noqa: PLC0415

    root, out = painted(), tmp_path_factory.mktemp("page") / "report.html"
    assert main(["report", str(root), "--out", str(out), "--detail", "1"]) == 0
    return root, out.read_text()


def loads(html):
    """Addresses that a browser would fetch or go to, in the page and in every image within it."""
    tree = ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    for element in tree.iter():
        assert element.tag.rpartition("}")[2] not in {"script", "link", "iframe", "object", "embed", "base", "form"}
        for name, value in element.attrib.items():
            assert not name.startswith("on"), f"{name} runs a script"
            if name.rpartition("}")[2] in {"src", "href", "srcset", "action", "data", "poster", "background"}:
                yield value
                if value.startswith("data:image/svg+xml;base64,"):
                    yield from loads(base64.b64decode(value.partition(",")[2]).decode().partition("?>")[2].strip())
        if element.tag.rpartition("}")[2] == "style":
            assert "@import" not in (element.text or "")
            yield from re.findall(r"url\(([^)]*)\)", element.text or "")


def loads_of(html):
    return [*loads(re.sub(r"<!DOCTYPE svg[^>]*>", "", html))]


def test_nothing_is_loaded_from_elsewhere(whole):
    _, html = whole
    addresses = loads_of(html)
    inside = [one for one in addresses if one.startswith("#")]
    embedded = [one for one in addresses if re.match(r"data:image/(png|jpeg|svg\+xml);base64,", one)]
    assert sorted(inside + embedded) == sorted(addresses)
    assert sum(one.startswith("data:image/svg") for one in embedded) == 5  # two maps, one run, histogram, spread
    assert any(one.startswith("data:image/jpeg") for one in embedded)


def test_every_link_leads_somewhere(whole):
    _, html = whole
    there = set(re.findall(r'id="([^"]*)"', html))
    links = re.findall(r'<a href="#([^"]*)"', html)
    assert len(links) >= 9
    assert set(links) <= there


def test_images_come_first_and_tables_are_folded(whole):
    _, html = whole
    body = html.partition("<h1>")[2]
    assert body.index("<img") < body.index("<table")
    tree = ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    open_tables = len(list(tree.iter("table"))) - sum(len(list(fold.iter("table"))) for fold in tree.iter("details"))
    assert open_tables == 1, "the table of seed and versions is short"


def test_every_image_can_be_enlarged_without_a_script(whole):
    _, html = whole
    tree = ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    images = list(tree.iter("img"))
    enlarged = [label for label in tree.iter("label") if label.find("input[@type='checkbox']") is not None]
    assert len(images) >= 17
    assert [label.find("span/img") for label in enlarged] == images


def test_the_same_release_gives_the_same_bytes(whole, symolo, tmp_path):
    root, html = whole
    out = tmp_path / "again.html"
    ended = symolo("report", root, "--out", out, "--detail", "1")
    assert (ended.code, ended.out) == (0, f"{out}: 3 runs, {out.stat().st_size / 1e6:.1f} MB\n")
    assert out.read_text() == html
    assert "tmp" not in words(html)


def test_images_are_those_of_the_release(whole):
    root, html = whole
    matches = re.findall(r'src="data:image/jpeg;base64,([^"]*)" alt="([^,"]*), image (\d+)"', html)
    assert len(matches) == 12  # six of each state
    for data, run, number in matches:
        assert base64.b64decode(data) == (root / run / f"images/{int(number):06d}.jpg").read_bytes()


def test_the_head_says_what_is_in_it(painted):
    root = painted()
    text = words(text_page(root))
    # Three runs of 40 steps of 50 ms and 10 mm, but for one that goes 30 mm sideways as well: 0.39 m + 0.0316 m.
    assert "3 runs on 2 routes, 6.0 s and 1.3 m of driving: 123 rows, 33 images. Licence: CC-BY-4.0." in text
    files = [path for path in root.rglob("*") if path.is_file() and "manifest" not in path.name]
    size = sum(path.stat().st_size for path in files) / 1e6
    assert f"Size {size:.1f} MB in {len(files)} files" in text
    assert "33, 5 per second, 48 x 32 px" in text


def test_each_run_has_a_row_with_its_farthest_place_off_the_line(painted):
    text = words(text_page(painted()))
    for run in ("CW/test_1", "CW/test_2", "CCW/test_1"):
        assert f"{run} 2.0 - 0.42 41 11 30.0 0 5 0" in text


def test_an_arena_without_a_line_has_no_distance_from_it(painted):
    text = words(text_page(painted(settings=["arena.line.pieces=[]"])))
    assert "CW/test_1 2.0 - 0.42 41 11 - 0 5 0" in text
    assert "The robot never follows the line." in text


def test_of_many_runs_some_are_shown_and_the_page_says_so(painted):
    root = painted(settings=["routes.0.runs=4"])
    html = text_page(root, max_detailed=2)
    assert "2 of 5 runs are shown in detail, spread evenly over all of them." in words(html)
    assert "middle half and median. 3 of 5 runs are shown." in words(html)
    assert re.findall(r'<h3 id="run-([^"]*)">', html) == ["CW/test_1", "CCW/test_1"]
    assert re.findall(r'href="#run-([^"]*)"', html) == ["CW/test_1", "CCW/test_1"]
    assert "are shown in detail" not in words(text_page(root, max_detailed=5))
    assert "1 of 30 maps are shown." in words(text_page(root, maps=30))
    assert "maps are shown" not in words(text_page(root, maps=1))


def test_warnings_and_runs_set_aside_are_named_and_linked_from_the_top(painted):
    failed = [FailedRun(run="CW/test_9", stage="simulate", problem="hit the wall A2 at 12.3 s")]
    html = text_page(painted(warnings=["3 of 10 images are black"], failed=failed))
    text = words(html)
    assert "1 warning, 1 run excluded" in text
    assert html.index('href="#warnings" class="warn"') < html.index("Where the robot drove")
    assert "CW/test_1 3 of 10 images are black" in text
    assert "CW/test_9 simulate hit the wall A2 at 12.3 s" in text


def test_without_any_it_says_so(painted):
    text = words(text_page(painted()))
    assert "excluded" not in text.partition("What is in it")[0]
    assert "Warnings There are none: no run failed" in text


def test_one_run_has_one_draw_of_each_value(painted):
    (route,) = ["[{name: CW, start: {x_m: 0.55, y_m: -0.2, yaw_deg: -90}, runs: 1}]"]
    html = text_page(painted(settings=["routes.0.runs=1", f"routes={route}"]))
    assert "There is one run, so each field has one value." in words(html)
    assert 'class="strip"' not in html


def test_images_that_stand_out_are_named(painted):
    text = words(text_page(painted(grey=lambda run, image: 230 if (run, image) == (1, 7) else 100 + image)))
    assert "CW/test_2 image 7, mean grey 230, bright; this image only" in text


def test_markup_in_a_release_is_text_on_its_page(painted):
    failed = [FailedRun(run=HOSTILE, stage=HOSTILE, problem=HOSTILE)]
    html = text_page(painted(description=HOSTILE, licence=HOSTILE, warnings=[HOSTILE], failed=failed))
    assert "<script" not in html
    ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own page
    assert words(html).count(HOSTILE) >= 6


def test_all_cameras_are_side_by_side_and_scans_are_on_the_arena(sensing_release):
    data = load(sensing_release)
    run = data["CW/test_1"]
    rows = camera_rows(run)
    # The moments are at 0.1, 0.3 and 0.5 s; images are each 200 ms, and each 300 ms of the camera at the rear.
    shown = [[(image.camera, image.number) for image in row] for row in rows]
    numbers = [(1, 1), (2, 2), (3, 2)]
    assert shown == [[("left", fast), ("right", fast), ("camera", fast), ("rear", slow)] for fast, slow in numbers]
    files = {name: camera.image(1).path.read_bytes() for name, camera in {"camera": run, **run.cameras}.items()}
    assert {image.camera: image.jpeg for image in rows[0]} == files
    facts = release_facts(data, data.metadata, 1, LineReport())
    svgs = dict.fromkeys((table.name for table in run.sensor_tables), b"svg")
    media = Media(
        (b"svg",), 1, {"CW/test_1": b"svg"}, {}, {}, b"svg", b"svg", 1, svgs, run.name, {"lidar": b"scan"}, rows
    )
    text = words(page(facts, media))
    assert "What all cameras see" in text
    assert "rear image 2, 0.30 s" in text
    assert "rear 3 32 x 24 px 0.3 s" in text
    assert "Points of some scans" in text
    assert b"<image" in scan_plot(run, "lidar")  # the points, drawn once


def test_without_further_cameras_there_is_no_part_on_them(whole):
    root, html = whole
    assert camera_rows(load(root).runs[0]) == ()
    assert "What all cameras see" not in html


def test_the_page_of_a_simulated_release_explains_states_ranges_and_the_line_sensor(whole):
    _, html = whole
    text = words(html)
    assert "The logs have no states" not in text
    for present in ("are states", "change of the state", "saw no target", "black is 0", "Farthest off the line:"):
        assert present in text
