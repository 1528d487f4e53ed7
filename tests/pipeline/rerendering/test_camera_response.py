"""A look replaces the camera of a run, and the command says how to keep it."""

import json
import shlex
from pathlib import Path

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.rerendering.camera_response import response_warnings

MONOCHROME = (
    "look.camera=machine_vision",
    "look.camera.exposure_time_s=0.01",
    "look.camera.manual_exposure.iso=200",
)
KEPT = "look.camera={extends: machine_vision, exposure_time_s: 0.01, manual_exposure: {iso: 200}}"


def run(*settings):
    return draw_run(load_scenario("smoke", settings), "CW", 1)


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


COPY = "copy the value of look.camera in side/spec.json of a run into camera.yaml"


def settings_of(text, source=None):
    """Return the settings of a remedy, after copying the camera of the run as it says."""
    if source is not None and COPY in text:
        Path("camera.yaml").write_text(json.dumps(json.loads(source.model_dump_json())["look"]["camera"]))
    options = shlex.split(text.partition("; ")[2].rpartition("camera.yaml; ")[2].partition(" keeps it")[0])
    assert options[::2] == ["--set"] * (len(options) // 2)
    return options[1::2]


def test_a_monochrome_camera_with_manual_exposure_is_named_with_the_settings_that_keep_it():
    (text,) = response_warnings([run(*MONOCHROME)], [run("look=lab"), run("look=lab")])
    start = "the camera of the run (machine_vision, monochrome, manual exposure) gives way to that of the look lab; "
    assert text.startswith(start)
    assert text.endswith(" keeps it")
    assert settings_of(text) == [KEPT]
    kept = run("look=lab", *settings_of(text))
    assert response_warnings([run(*MONOCHROME)], [kept]) == ()
    assert kept.look.camera == run(*MONOCHROME).look.camera


@pytest.mark.parametrize(
    "settings",
    [
        (*MONOCHROME, "look.camera.manual_exposure.base_iso=50", "look.camera.manual_exposure.f_number=4"),
        ("look.camera=phone", "look.camera.vignetting=0.35", "look.camera.exposure_time_s=0.00001234567"),
        ("look.camera.colour_filter=monochrome",),
        ("look.camera=raspberry_pi", "look.camera.colour_filter=monochrome"),
    ],
)
@pytest.mark.parametrize("look", ["look=lab", "look=extreme"])
def test_the_settings_give_the_whole_camera_back(settings, look):
    (text,) = response_warnings([run(*settings)], [run(look)])
    assert run(look, *settings_of(text, run(*settings))).look.camera == run(*settings).look.camera


def test_the_many_settings_of_a_camera_of_its_own_are_taken_from_a_file_in_place_of_the_command_line():
    own = ("look.camera=phone", "look.camera.name=mine", "look.camera.description='ours: \"no. 1\", 5 %'")
    (text,) = response_warnings([run(*own)], [run("look=extreme")])
    assert len(text) < 230
    assert COPY in text
    assert run("look=extreme", *settings_of(text, run(*own))).look.camera == run(*own).look.camera


def test_only_a_camera_that_the_user_names_is_replaced_without_a_word():
    source, other = [run(*MONOCHROME)], [run("look=lab", "look.camera.vignetting=0.1")]
    assert len(response_warnings(source, other, ("look.camera={vignetting: 0.1}",))) == 1
    assert response_warnings(source, other, ("look.camera=phone",)) == ()
    assert response_warnings(source, other, ("look.camera={extends: phone}",)) == ()


def test_a_manual_exposure_of_the_look_is_taken_away_again():
    manual = "extends: lab\ncamera: {exposure_time_s: 0.02, manual_exposure: {iso: 200, base_iso: 50}}\n"
    Path("manual.yaml").write_text(manual)
    grey = ("look.camera.colour_filter=monochrome",)
    slower = (*grey, "look.camera.exposure_time_s=0.02", "look.camera.manual_exposure={iso: 200, f_number: 4}")
    for settings in (grey, slower):
        source = run(*settings)
        (text,) = response_warnings([source], [run("look=manual.yaml")])
        assert run("look=manual.yaml", *settings_of(text, source)).look.camera == source.look.camera


def test_a_camera_that_the_user_names_replaces_that_of_the_run_without_a_word():
    after = [run("look=lab", "look.camera=phone")]
    assert response_warnings([run(*MONOCHROME)], after, ("look.camera=phone",)) == ()
    assert len(response_warnings([run(*MONOCHROME)], after, ("look.camera.vignetting=0.1",))) == 1


def test_numbers_that_differ_between_the_runs_are_named_once_as_not_kept():
    runs = [run(*MONOCHROME, f"look.camera.vignetting={vignetting}") for vignetting in (0.1, 0.3, 0.4)]
    (text,) = response_warnings(runs, [run("look=lab")] * 3)
    assert text.endswith(" keeps it, except for what is not the same in all runs: vignetting")
    assert settings_of(text) == [KEPT]


@pytest.mark.parametrize("settings", [(), ("look.camera.vignetting=0.4",)])
def test_an_ordinary_camera_is_replaced_without_a_word(settings):
    assert response_warnings([run(*settings)], [run("look=lab"), run("look=night")]) == ()


def test_each_look_that_replaces_a_camera_is_named_once():
    after = [run(f"look={look}") for look in ("lab", "lab", "night", "night")]
    texts = response_warnings([run(*MONOCHROME)] * 2, after)
    assert [text.partition(" look ")[2].partition(";")[0] for text in texts] == ["lab", "night"]
