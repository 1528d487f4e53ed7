import pytest

from pipeline import doctor


@pytest.mark.parametrize(("devices", "found"), [("", "none"), ("H200 (CUDA)", "H200 (CUDA)")])
def test_a_graphics_card_is_not_said_to_be_used(devices, found, monkeypatch):
    monkeypatch.setattr(doctor, "_child", lambda _program: (0, f"version 4.5.0\ndevices {devices}\n", ""))
    _, card = doctor._blender()
    assert card.ok
    assert card.found == f"{found}; not used yet, pictures are rendered on the CPU"
