"""A release without images: what is in it, what needs images, and images that are made of it later."""

import json

import numpy as np
import pytest

import symolo as library
from configs.loader import load_scenario
from configs.schema.scenario import Rates
from pipeline.cli import main
from pipeline.commands import stages
from symolo.core.errors import InputError
from symolo.dataset.documents.run_records import RatesRecord
from symolo.dataset.rates import period_beside_rows_s
from symolo.dataset.tables.camera_rows import image_column
from tests.release_fixtures import ONE_ROUTE

NO_IMAGES = "rates.camera_hz=0"
SETTINGS = (
    NO_IMAGES,
    ONE_ROUTE,
    "stop.time_limit_s=0.6",
    "render.width_px=32",
    "render.height_px=24",
)
RUN = "CW/test_1"


@pytest.fixture(scope="module")
def made(hands_of_module, tmp_path_factory):
    """A release without images, made where there is no Blender; read only."""
    del hands_of_module
    root = tmp_path_factory.mktemp("without") / "data"
    installed = stages.check_installed
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stages, "check_installed", lambda name: installed(name if name != "bpy" else "no_such_package"))
        options = [f"--set={setting}" for setting in SETTINGS]
        assert main(["release", "smoke", "--out", str(root), "--workers", "1", *options]) == 0
    return root


def test_it_has_the_tables_and_nothing_of_a_camera(made, symolo):
    assert symolo("verify", made).out == f"{made}: no fault\n"
    files = {path.name for path in (made / RUN).rglob("*") if path.is_file()}
    assert files == {"data.csv", "wheels.csv", "tof.csv", "spec.json"}
    run = library.load(made)[RUN]
    assert (len(run.images), run.rows["img"].tolist(), run.X_WC.shape) == (0, 13 * [0], (0, 4, 4))
    with pytest.raises(InputError, match="has no images, and so no camera"):
        _ = run.camera
    metadata = json.loads((made / "metadata.json").read_text())
    assert metadata["runs"][0]["images"] == metadata["runs"][0]["rates"]["camera_hz"] == 0
    assert "bpy" not in metadata["made_with"]
    assert "and there are no images" in (made / "README.md").read_text()
    assert not (made / ".stages/render").exists()
    assert "release done" in symolo("status", made).out


def test_what_is_lost_of_it_is_restored(made, copy_of, symolo):
    copy = copy_of(made)
    (copy / RUN / "data.csv").unlink()
    assert symolo("repair", copy).code == 0
    assert symolo("compare", made, copy).code == 0


def test_formats_of_images_refuse_it_and_others_take_it(made, tmp_path, symolo):
    for name in ("kitti", "webdataset", "lerobot", "coco", "yolo"):
        refused = symolo("export", made, "--format", f"tum,{name}", "--out", tmp_path / name)
        assert (refused.code, f"format {name}: run {RUN} has no images" in refused.err) == (2, True)
    assert symolo("export", made, "--format", "tum,euroc", "--out", tmp_path / "tables").code == 0


def test_images_are_made_of_it_later(made, tmp_path, symolo):
    out = tmp_path / "later"
    ended = symolo("rerender", made, "--look", "lab", "--out", out)
    assert ended.code == 0, ended.err
    assert symolo("verify", out).code == 0
    images = library.load(out)[RUN].images
    assert [image.t_s for image in images] == [0.0, 0.2, 0.4, 0.6]  # at 5 Hz, as in SyMoLo
    np.testing.assert_array_equal([image.pose for image in images], library.load(made)[RUN].table.pose[::4])


def test_the_plan_has_no_images_and_no_rendering(symolo):
    plan = symolo("plan", "smoke", "--set", NO_IMAGES).out
    assert "images     0\n" in plan
    assert "render" not in plan


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("render.annotations=[depth]", "annotations: got 'depth', allowed: none, since rates.camera_hz is 0"),
        ("splits={by: image}", "splits.by: got 'image', allowed: a property of runs, since rates.camera_hz is 0"),
        ("rates.camera_hz=0.0009", "rates.camera_hz: got 0.0009, allowed: at least 0.001, or 0 for no images"),
        (
            "robot.sensors.eye={kind: camera, x_m: 0.06, y_m: 0.0, z_m: 0.12, width_px: 32, height_px: 24, rate_hz: 2}",
            "robot.sensors.eye; allowed: no camera, since rates.camera_hz is 0",
        ),
    ],
)
def test_what_needs_images_is_refused(setting, message):
    with pytest.raises(InputError) as refused:
        load_scenario("smoke", [NO_IMAGES, setting])
    assert message in str(refused.value)


def test_a_rate_of_0_takes_no_image_at_any_row():
    rates = Rates(camera_hz=0)
    assert not image_column(np.arange(0, 1000, 50), rates).any()
    assert period_beside_rows_s(rates) is None
    assert RatesRecord.model_validate(rates.model_dump()).camera_hz == 0
