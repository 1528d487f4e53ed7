import pytest

from pipeline import doctor


@pytest.mark.parametrize(
    ("devices", "found"),
    [
        ("", "none; the CPU renders"),
        ("H200 (CUDA)", "H200 (CUDA); used with --device auto or gpu; the CPU is the default"),
    ],
)
def test_a_graphics_card_is_reported_with_the_option_that_uses_it(devices, found, monkeypatch):
    monkeypatch.setattr(doctor, "_child", lambda _program: (0, f"version 4.5.0\ndevices {devices}\n", ""))
    _, card = doctor._blender()
    assert card.ok
    assert card.result == found
