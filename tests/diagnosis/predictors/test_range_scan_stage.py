"""The stage of a scan over a round object, by scans whose every ray is summed apart."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.base import Slot
from configs.loader import load_section
from diagnosis.diagnose import diagnose
from diagnosis.discovery.discover import with_law
from diagnosis.importers.vl53l0x_scan import IMPORTER
from diagnosis.validation.range_sensor.recordings.ball_scene import BallScene
from diagnosis.validation.range_sensor.stand import HEIGHT_M
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting
from sensors.ranging.tof import ray_pattern
from symolo.core.errors import InputError


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 0, "test")[0]


@pytest.fixture
def scanned(robot, tmp_path):
    """A scan over a ball at 150 mm before a board at 950 mm, with three readings of each point."""

    def write(exponent, radius_m, rays=1000):
        tof, rng = robot.tof, np.random.default_rng(4)
        angle, roll = ray_pattern(rays, np.radians(tof.field_of_view_deg))
        steps = 3.0 * np.stack([np.cos(angle), np.sin(angle) * np.cos(roll), np.sin(angle) * np.sin(roll)], axis=1)
        beam, slant = np.exp(-0.5 * (np.degrees(angle) / tof.beam_sigma_deg) ** 2), 1.0 / np.cos(angle)

        def mean(distance, cosine):
            weight = beam * cosine / distance**exponent
            return np.sum(weight * distance) / np.sum(weight)

        lines = ["x,y,lidar"]
        for x_mm in range(0, 141, 5):
            for y_mm in range(0, 141, 5):
                scene = BallScene(0.15, radius_m, 0.95, 0.07, HEIGHT_M + 0.07)
                origin = np.array([0.0, 1e-3 * x_mm, HEIGHT_M + 1e-3 * y_mm])
                hits = scene.cast(np.tile(origin, (rays, 1)), origin + steps)
                cosine = np.abs(np.sum(steps * hits.normal, axis=1)) / 3.0
                # The device is calibrated on a flat board.
                range_mm = 1e3 * mean(3.0 * hits.fraction, cosine) / mean(slant, 1.0 / slant)
                lines += [f"{x_mm},{y_mm},{round(range_mm + 0.5 * rng.standard_normal())}" for _ in range(3)]
        path = tmp_path / "scan.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write


def test_light_that_falls_with_the_square_is_named_with_its_exponent(scanned):
    answer = diagnose(IMPORTER.read(scanned(2.0, 0.035))).answer()
    (effect,) = answer["effects"]
    assert effect["name"] == "range_signal_weighting"
    assert effect["parameters"]["exponent"] == pytest.approx(2.0, abs=0.3)
    assert answer["heldout_gain"] > 0.3


@pytest.mark.long
def test_taken_out_of_the_list_the_fall_of_the_weight_is_a_law(scanned, monkeypatch):
    monkeypatch.setattr(RangeSignalWeighting, "setups", ())
    law = with_law(diagnose(IMPORTER.read(scanned(2.0, 0.035)))).law
    assert law.form.place.slot is Slot.RAY_WEIGHT
    assert law.form.shape == "power" or any("with a power of the distance" in words for words, _ in law.rivals)
    assert law.gain.low > 0.3


def test_a_scan_by_the_sensors_own_weights_has_no_cause(scanned):
    # By this law a small ball hardly shows before the board.
    assert diagnose(IMPORTER.read(scanned(0.0, 0.07))).answer()["effects"] == []


def test_a_scan_without_a_near_object_is_refused(tmp_path):
    path = tmp_path / "flat.csv"
    path.write_text("x,y,lidar\n" + "".join(f"{x},{y},{500}\n" * 3 for x in range(6) for y in range(6)))
    with pytest.raises(InputError, match=r"flat\.csv: no near object in front of a far one.*round object"):
        diagnose(IMPORTER.read(path))
