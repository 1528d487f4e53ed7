"""A look replaces the camera of a run, and the command says how to keep it."""

import shlex

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.rerendering.camera_response import response_warnings

MONOCHROME = (
    "look.camera=machine_vision",
    "look.camera.exposure_time_s=0.01",
    "look.camera.manual_exposure.iso=200",
)


def run(*settings):
    return draw_run(load_scenario("smoke", settings), "CW", 1)


def test_a_monochrome_camera_with_manual_exposure_is_named_with_the_settings_that_keep_it():
    (text,) = response_warnings([run(*MONOCHROME)], [run("look=lab"), run("look=lab")])
    start = "the camera of the run (machine_vision, monochrome, manual exposure) gives way to that of the look lab; "
    assert text.startswith(start)
    assert text.endswith(" keeps it")
    words = shlex.split(text.removeprefix(start).removesuffix(" keeps it"))
    assert words[::2] == ["--set"] * 3
    kept = run("look=lab", *words[1::2])
    assert response_warnings([run(*MONOCHROME)], [kept]) == ()
    assert kept.look.camera == run(*MONOCHROME).look.camera


@pytest.mark.parametrize("settings", [(), ("look.camera.vignetting=0.4",)])
def test_an_ordinary_camera_is_replaced_without_a_word(settings):
    assert response_warnings([run(*settings)], [run("look=lab"), run("look=night")]) == ()


def test_each_look_that_replaces_a_camera_is_named_once():
    after = [run(f"look={look}") for look in ("lab", "lab", "night", "night")]
    texts = response_warnings([run("look.camera.colour_filter=monochrome")] * 2, after)
    assert [text.partition(" look ")[2] for text in texts] == [
        f"{look}; --set look.camera.colour_filter=monochrome keeps it" for look in ("lab", "night")
    ]
