"""Cameras of a look that are named or extended, in files and on the command line."""

from pathlib import Path

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario, load_section
from configs.references import shipped_names
from configs.schema.appearance.camera_look import CameraLook
from symolo.core.errors import InputError


def camera(*overrides):
    return draw_all(load_scenario("smoke", overrides))[0].look.camera


@pytest.mark.parametrize("name", shipped_names("camera"))
def test_a_named_camera_replaces_all_settings_of_the_look(name):
    camera_look = camera("look=garage", f"look.camera={name}")
    assert camera_look.name == name
    assert camera_look == camera("look=night", f"look.camera={name}")


def test_nothing_of_the_camera_of_the_look_remains_in_that_of_a_file_which_leaves_out_name_and_exposure(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("mine.yaml").write_text("vignetting: 0.3\n")
    over_lab = camera("look=lab", "look.camera.manual_exposure={iso: 200}", "look.camera.exposure_time_s=0.01")
    assert (over_lab.name, over_lab.manual_exposure.iso) == ("raspberry_pi", 200)
    Path("look.yaml").write_text("extends: lab\ncamera: mine.yaml\n")
    for mine in (camera("look=lab", "look.camera=mine.yaml"), camera("look=look.yaml")):
        assert mine == CameraLook(vignetting=0.3)


def test_a_setting_after_the_name_changes_that_setting_only():
    named, changed = camera("look.camera=phone"), camera("look.camera=phone", "look.camera.vignetting=0.33")
    assert changed == named.model_copy(update={"vignetting": 0.33})


@pytest.mark.parametrize(
    ("texts", "lost"),
    [
        (("look.camera=phone", "look=garage"), "look.camera"),
        (("look.camera.vignetting=0.3", "look.camera={extends: phone}"), "look.camera.vignetting"),
        (("robot.wheel.radius_m=0.04", "seed=3", "robot=nominal"), "robot.wheel.radius_m"),
        (("look={camera: {vignetting: 0.9}}", "look.camera=phone"), "look"),
        (("look.camera={vignetting: 0.9}", "look.camera=phone"), "look.camera"),
        (("robot={drive: {track_m: 0.13}}", "robot=nominal"), "robot"),
    ],
)
def test_a_setting_before_the_name_that_replaces_it_is_refused(texts, lost):
    with pytest.raises(InputError, match=f"discards the earlier --set {lost}; put the option with the name first"):
        load_scenario("smoke", texts)


def test_names_that_replace_each_other_are_no_fault():
    assert camera("look=garage", "look=night", "look.camera=phone", "look.camera=webcam").name == "webcam"


def test_a_named_camera_has_no_manual_exposure_of_the_look(tmp_path):
    exposed = "extends: garage\nname: exposed\ncamera: {exposure_time_s: 0.01, manual_exposure: {iso: 100}}\n"
    (tmp_path / "exposed.yaml").write_text(exposed)
    assert camera(f"look={tmp_path / 'exposed.yaml'}").manual_exposure.iso == 100
    assert camera(f"look={tmp_path / 'exposed.yaml'}", "look.camera=phone").manual_exposure is None


def test_files_name_and_extend_cameras_and_keep_nothing_of_the_look_that_they_extend(tmp_path):
    (tmp_path / "mine.yaml").write_text("extends: webcam\nname: mine\nshot_noise: {uniform: [0.1, 0.2]}\n")
    (tmp_path / "look.yaml").write_text("extends: garage\nname: dim\ncamera: ./mine.yaml\n")
    (tmp_path / "scenario.yaml").write_text(
        "extends: smoke\nname: s\nlook: {camera: {extends: ./mine.yaml, contrast: 1}}\n"
    )
    look = load_section("look", str(tmp_path / "look.yaml"))
    assert [path for path in look.distributions if "camera" in path] == [("look", "camera", "shot_noise")]
    camera_look = draw_all(load_scenario(str(tmp_path / "scenario.yaml")))[0].look.camera
    webcam = camera("look.camera=webcam")
    assert 0.1 <= camera_look.shot_noise <= 0.2
    expected = {"name": "mine", "contrast": 1.0, "shot_noise": camera_look.shot_noise}
    assert camera_look == webcam.model_copy(update=expected)


def test_a_name_that_is_not_shipped_is_refused_with_the_nearest_one():
    with pytest.raises(InputError) as refused:
        load_scenario("smoke", ["look.camera=fone"])
    assert "look.camera" in str(refused.value)
    assert "machine_vision, phone, raspberry_pi, webcam" in str(refused.value)
    with pytest.raises(InputError, match=r"camera\.typo"):
        load_scenario("smoke", ["look.camera={extends: phone, typo: 1}"])


def test_settings_without_effect_are_not_written():
    assert set(CameraLook().model_dump()) == set(CameraLook.model_fields) - {
        *("name", "description", "defocus_share", "pixel_px", "colour_filter", "noise_reduction", "colour_blur_px"),
        *("manual_exposure", "shading_right_ev", "shading_down_ev"),
    }
