"""Temperatures of gains against white points of CIE and Rec. 709."""

from types import SimpleNamespace

import pytest

from configs.schema.appearance.look import LookConfig
from diagnosis.camera.extended_camera import left_out, look_changes
from diagnosis.camera.features.white_balance import temperature_of


def test_equal_gains_are_daylight_of_6504_K():
    """White of Rec. 709 is CIE's D65."""
    assert temperature_of(1.0, 1.0) == pytest.approx(6504.0, rel=0.01)


@pytest.mark.parametrize(
    ("name_K", "x", "y"), [(5003.0, 0.34567, 0.35850), (5503.0, 0.33242, 0.34743), (7504.0, 0.29902, 0.31485)]
)
def test_gains_that_render_a_cie_daylight_neutral_are_those_of_its_temperature(name_K, x, y):
    """D50, D55 and D75 by their published chromaticities; the matrix is that of IEC 61966-2-1."""
    light = (x / y, 1.0, (1.0 - x - y) / y)
    rows = ((3.2406, -1.5372, -0.4986), (-0.9689, 1.8758, 0.0415), (0.0557, -0.2040, 1.0570))
    red, green, blue = (sum(a * b for a, b in zip(row, light, strict=True)) for row in rows)
    assert temperature_of(green / red, green / blue) == pytest.approx(name_K, rel=0.01)


def test_gains_of_a_green_light_are_those_of_no_temperature():
    assert temperature_of(1.5, 1.5) is None
    assert temperature_of(1.5, 1.5, 0.2, 0.2) is not None


def diagnosis_of(**gains):
    """As far as the look file asks it, of a camera that is nominally balanced for D65; both gains are named."""
    parameters = [SimpleNamespace(name=name) for name in gains]
    named = [SimpleNamespace(place=place, parameter=parameter) for place, parameter in enumerate(parameters)]
    part = SimpleNamespace(
        model=SimpleNamespace(parameters=parameters),
        selection=SimpleNamespace(named=named),
        value=lambda place, _case: (list(gains.values())[place], 0.005),
    )
    case = SimpleNamespace(look=LookConfig(name="made"), response=SimpleNamespace(white_balance=(1.0, 1.0, 1.0)))
    return SimpleNamespace(case=case, photometry=(part,), named=[(part, one) for one in named])


def test_the_look_file_has_the_temperature_of_both_gains_and_no_adaption():
    """Of D50, whose light has 1.176, 0.976 and 0.722 of Rec. 709's primaries."""
    diagnosis = diagnosis_of(red_gain_scale=0.976 / 1.176, blue_gain_scale=0.976 / 0.722)
    changed = look_changes(diagnosis)
    assert changed.keys() == {"white_balance_K", "white_balance_adaption"}
    assert changed["white_balance_K"] == pytest.approx(5003.0, rel=0.01)
    assert changed["white_balance_adaption"] == 0.0
    assert left_out(diagnosis) == []


def test_gains_of_no_temperature_are_said_to_be_left_out():
    diagnosis = diagnosis_of(red_gain_scale=1.5, blue_gain_scale=1.5)
    assert look_changes(diagnosis) == {}
    assert [name for name, _ in left_out(diagnosis)] == ["red_gain_scale", "blue_gain_scale"]
