"""All faults of a scenario file are reported together, each in one line with its place, and each fault once."""

import re

import cv2
import numpy as np
import pytest

from configs.loader import load_scenario
from configs.references import shipped_names
from symolo.core.errors import FaultsError, InputError

FILE = """\
extends: smoke
name: several
render: {widthpx: 100, height_px: -5, quality: standart}
robot: {extends: nominal, drive: {track: 0.1}}
look: {extends: lab, sun: {elevation_deg: 400}}
routes:
  - {name: CW, start: {x: 0.5, y_m: 0.1, yaw_deg: 90}, runs: 0}
"""


@pytest.fixture
def faults(tmp_path):
    """Loads a scenario with these lines and returns the lines of its error, without their number."""

    def load(text):
        path = tmp_path / "several.yaml"
        path.write_text(text)
        with pytest.raises(InputError) as raised:
            load_scenario(str(path))
        first, *lines = str(raised.value).splitlines()
        return [line.strip().replace(f"{path}:", "line ") for line in lines] if lines else [first]

    return load


def test_each_fault_has_a_line_with_its_place_and_what_is_allowed(faults):
    lines = faults(FILE)
    places = [re.match(r"line (\d+): ([\w.]+):", line).groups() for line in lines]
    assert sorted(places) == [
        ("3", "render.height_px"),
        ("3", "render.quality"),
        ("3", "render.widthpx"),
        ("4", "robot.drive.track"),
        ("5", "look.sun.elevation_deg"),
        ("7", "routes.0.runs"),
        ("7", "routes.0.start.x"),
    ]
    fault = dict(zip((path for _, path in places), lines, strict=True))
    assert "allowed: x_m, y_m, yaw_deg; did you mean x_m" in fault["routes.0.start.x"], "and x_m is not missing as well"
    assert "did you mean standard" in fault["render.quality"]


def test_the_list_of_allowed_keys_is_complete(faults):
    (line,) = faults("extends: smoke\nname: a\nlook: {extends: lab, floor: {fabric: wool}}\n")
    allowed = line.partition("allowed: ")[2].partition(";")[0].split(", ")
    assert {"material", "linoleum", "parquet", "image"} <= set(allowed)
    assert "more" not in line


def test_faulty_distributions_are_reported_together(faults):
    lines = faults(
        "extends: smoke\nname: a\n"
        "seed: {uniform: [1, 2]}\n"
        "look: {extends: lab, sun: {elevation_deg: {uniform: [9]}}}\n"
        "render: {width_px: {normal: [64, 1]}}\n"
    )
    assert len(lines) == 3
    for path in ("seed", "look.sun.elevation_deg", "render.width_px"):
        assert any(f": {path}" in line for line in lines), path


def test_contradictions_are_reported_together(faults):
    lines = faults(
        "extends: smoke\nname: a\n"
        "robot: {extends: nominal, tof: {period_s: 0.0333}}\n"
        "routes:\n"
        "  - {name: CW, start: {x_m: 49, y_m: 49, yaw_deg: 0}, runs: 1}\n"
        "  - {name: cw, start: {x_m: 0.55, y_m: -0.2, yaw_deg: 90}, runs: 1}\n"
    )
    paths = {re.match(r"line \d+: ([\w.]+):", line).group(1) for line in lines}
    assert {"robot.tof.period_s", "routes.1.name", "routes.0.start"} <= paths


def test_all_faults_of_the_text_are_reported_together(faults):
    lines = faults(
        "extends: smoke\nname: a\nname: b\n"
        "stop: {time_limit_s: .nan}\n"
        "seed: &seed 3\n"
        "render: {samples: *seed, samples: 1, width_px: !!int 64}\n"  # the alias belongs to the anchor
        "routes:\n"
        "  - {name: CW, start: {x_m: .inf, y_m: -0.2, yaw_deg: 1e999}, runs: 1}\n"
    )
    places = sorted(re.match(r"line (\d+): ([\w.]+):", line).groups() for line in lines)
    assert places == [
        ("3", "name"),
        ("4", "stop.time_limit_s"),
        ("5", "seed"),
        ("6", "render.samples"),
        ("6", "render.width_px"),
        ("8", "routes.0.start.x_m"),
        ("8", "routes.0.start.yaw_deg"),
    ]


def test_sections_that_cannot_be_loaded_are_reported_with_the_other_faults(faults):
    lines = faults(
        "extends: smoke\nname: a\n"
        "look: [classroom]\n"
        "robot: nominl\n"
        "arena: {extends: nowhere, walls: 3}\n"
        "render: [width_px, 32]\n"
        "sed: 1\n"
        "stop: {time_limit_s: {normal: [3]}}\n"
    )
    places = sorted(re.match(r"line (\d+): ([\w.]+):", line).groups() for line in lines)
    assert places == [
        ("3", "look"),
        ("4", "robot"),
        ("5", "arena.extends"),
        ("6", "render"),
        ("7", "sed"),
        ("8", "stop.time_limit_s"),
    ]


@pytest.mark.parametrize("section", ["look", "robot", "arena"])
@pytest.mark.parametrize("name", shipped_names("scenario"))
def test_a_section_that_cannot_be_loaded_is_the_only_fault_of_a_good_scenario(faults, name, section):
    (line,) = faults(f"extends: {name}\nname: a\n{section}: nowhere\n")
    assert f"several.yaml:3: {section}: got 'nowhere'" in line


def test_short_forms_and_files_of_the_user_are_no_faults_beside_another(faults, tmp_path):
    cv2.imwrite(str(tmp_path / "mine.png"), np.full((32, 32, 3), 90, np.uint8))
    lines = faults(
        "extends: smoke\nname: a\n"
        "arena: {extends: symolo,"
        " line: {course: {shape: spline, points: [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]}}}\n"
        "look: {extends: lab, assets: ., floor: {material: image, image: {file: mine.png}}}\n"
        "robot: nowhere\n"
    )
    assert len(lines) == 1
    assert "robot: got 'nowhere'" in lines[0]
    lines = faults(
        "extends: smoke\nname: a\nlook: {extends: lab, assets: ., floor: {image: {file: yours.png}}}\nsed: 1\n"
    )
    assert len(lines) == 2
    assert "no such file" in lines[0]
    assert "sed: unknown key" in lines[1]


def test_faulty_distributions_are_reported_with_the_other_faults(faults):
    lines = faults(
        "extends: smoke\nname: a\n"
        "look: {extends: lab, floor: {dirt: {normal: [0.5]}, material: {choice: [parqet]}}}\n"
        "render: {widthpx: 64, height_px: {uniform: [1, 4]}}\n"
        "arena: {extends: symolo, obstacles: [{name: A, kind: {choice: [box, ball]}}]}\n"
    )
    places = sorted(re.match(r"line (\d+): ([\w.]+):", line).groups() for line in lines)
    assert ("3", "look.floor.dirt.normal") in places
    assert ("3", "look.floor.material") in places
    assert ("4", "render.widthpx") in places
    assert len(places) == len(set(places))


def test_one_fault_is_one_line(tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text("extends: smoke\nsed: 1\n")
    with pytest.raises(InputError) as raised:
        load_scenario(str(path))
    assert not isinstance(raised.value, FaultsError)
    assert "\n" not in str(raised.value)


def test_a_derived_scenario_has_no_texts_of_its_parent(tmp_path):
    (tmp_path / "my drive.yaml").write_text("extends: smoke\nrender: {width_px: 64}\n")
    derived = load_scenario(str(tmp_path / "my drive.yaml"))
    assert (derived.name, derived.description) == ("my-drive", "")
    assert derived.tree["render"]["width_px"] == 64
    (tmp_path / "named.yaml").write_text("extends: my drive.yaml\nname: named\ndescription: Mine\n")
    named = load_scenario(str(tmp_path / "named.yaml"))
    assert (named.name, named.description) == ("named", "Mine")
    assert named.tree["render"]["width_px"] == 64
    assert load_scenario("smoke").description == "A short drive on each of both routes, with small images"
