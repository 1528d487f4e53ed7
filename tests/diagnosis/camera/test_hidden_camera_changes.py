"""Changes that are hidden in images of an independent generator (`tests/camera_cases`) are identified."""

import json
from xml.etree import ElementTree as ET

import pytest
import yaml

from configs.draw import draw_look, draw_robot
from configs.loader import load_section
from diagnosis.camera.diagnose import diagnose_camera
from diagnosis.camera.files import files
from symolo.core.errors import InputError


def effects(diagnosis):
    return {effect["name"]: effect for effect in diagnosis.answer()["effects"]}


def near(effect, true):
    return abs(effect["value"] - true) < 3 * effect["std"]


@pytest.fixture(scope="module")
def as_simulated(make_case):
    return diagnose_camera(make_case(compared=True))


@pytest.fixture(scope="module")
def changed(make_case, generator):
    hidden = generator.Hidden(gain=1.3, blur_px=(0.4**2 + 1.0) ** 0.5)
    return diagnose_camera(make_case(generator.Camera(pitch_deg=32.0), hidden, compared=True))


def test_nothing_is_named_where_nothing_is_hidden(as_simulated):
    answer = as_simulated.answer()
    assert answer["effects"] == []
    assert not answer["unexplained"]
    assert {"report.html", "answer.json"} <= files(as_simulated).keys()


def test_a_camera_that_sits_higher_is_found(make_case, generator):
    diagnosis = diagnose_camera(make_case(generator.Camera(z_m=generator.Camera().z_m + 0.006)))
    deviations = effects(diagnosis)
    assert deviations.keys() == {"height"}
    assert "no simulated images" in diagnosis.answer()["not_measured"][0]
    assert near(deviations["height"], 0.006)


def test_another_focal_length_is_found(make_case, generator):
    lens = generator.Lens(focal_px_per_width=0.95 * 30 / 42.33)
    deviations = effects(diagnose_camera(make_case(generator.Camera(lens=lens))))
    assert deviations.keys() == {"focal_length_scale"}
    assert near(deviations["focal_length_scale"], 0.95)


def test_pitch_exposure_and_blur_are_found_together(changed):
    deviations = effects(changed)
    assert deviations.keys() == {"pitch_down", "exposure_scale", "lens_blur"}
    assert near(deviations["pitch_down"], 2.0)
    assert deviations["exposure_scale"]["value"] == pytest.approx(1.3, rel=0.05)
    assert deviations["lens_blur"]["value"] == pytest.approx(1.0, rel=0.1)


def test_what_was_found_predicts_pictures_that_nothing_was_fitted_to(changed):
    heldout = changed.answer()["heldout"]
    assert heldout["geometry"]["gain_low"] > 0.5
    assert heldout["levels"]["gain_low"] > 0.5


def test_the_files_say_it_and_are_a_robot_and_a_look(changed, tmp_path):
    made = files(changed)
    for name, data in made.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    assert json.loads(made["answer.json"]) == changed.answer()
    ET.fromstring(made["report.html"].decode().removeprefix("<!DOCTYPE html>\n"))  # noqa: S314 - our own
    robot, _ = draw_robot(load_section("robot", str(tmp_path / "robot.yaml")), 1, "test")
    look, _ = draw_look(load_section("look", str(tmp_path / "look.yaml")), 1, "test", 1)
    assert robot.camera.pitch_down_deg == pytest.approx(32.0, abs=0.6)
    assert look.camera.compensation_ev == pytest.approx(0.3785, abs=0.1)
    assert yaml.safe_load(made["look.yaml"])["camera"]["lens_blur_px"] == pytest.approx(1.0, rel=0.1)


def test_pictures_that_show_no_line_are_refused_with_one_line(make_case, generator):
    with pytest.raises(InputError, match="edges are found at") as refused:
        diagnose_camera(make_case(generator.Camera(pitch_deg=-60.0)))
    assert "\n" not in str(refused.value)
