"""`symolo.load` gives back what was put into a release, and says in one line what is wrong with one."""

import json
import pickle
import shutil
import subprocess
import sys
import types

import cv2
import numpy as np
import pytest

import symolo as reader
from symolo.dataset.tables.rows import HEADER
from symolo.dataset.tables.side_tables import WHEELS


def test_rows_poses_and_side_tables_are_those_of_the_files(random_release):
    release = random_release(1)
    data = reader.load(release.root)
    assert [run.name for run in data] == [truth.name for truth in release.runs] == ["CW/test_1", "CCW/test_1"]
    for run, truth in zip(data, release.runs, strict=True):
        assert tuple(run.rows.columns) == HEADER
        np.testing.assert_array_equal(run.rows.to_numpy(), truth.table)
        np.testing.assert_array_equal(run.side("wheels").to_numpy(), truth.wheels)
        np.testing.assert_array_equal(run.X_WC, truth.X_WC)
        np.testing.assert_array_equal(run.camera.K, truth.K)
        assert {array.dtype.name for array in (run.camera.K, run.camera.D, run.camera.X_RC)} == {"float64"}
        pixel, _ = cv2.projectPoints(np.array([[0.0, 0.0, 2.0]]), np.zeros(3), np.zeros(3), run.camera.K, run.camera.D)
        np.testing.assert_allclose(pixel.ravel(), truth.K[:2, 2])
        assert (len(run), run.t_s[-1]) == (len(truth.table), truth.table[-1, 0] / 1000)
    kinds = {name: str(kind) for name, kind in data.runs[0].rows.dtypes.items()}
    assert {name for name, kind in kinds.items() if kind == "int64"} == {"t", "state", "img"}
    assert set(kinds.values()) == {"int64", "float64"}


def test_a_camera_has_all_of_its_document_with_arrays_that_cannot_be_written_to(random_release):
    camera = reader.load(random_release(1).root).runs[0].camera
    for name, value in camera.document:
        np.testing.assert_array_equal(getattr(camera, name), value)
    for array in (camera.K, camera.D, camera.X_RC, camera.X_CB):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_tables_know_their_units(random_release):
    data = reader.load(random_release(1).root)
    units = data.runs[0].rows.attrs["units"]
    assert (units["t"], units["x"], units["theta"], units["w"], units["L0"]) == ("ms", "m", "rad", "rad/s", "-")
    assert data.rows.attrs["units"] == {"run": "-", **units}
    assert data.runs[0].side("wheels").attrs["units"]["current_r"] == "A"
    assert data.runs[0].side_names == ("wheels", "tof", "camera")


def test_images_are_aligned_with_rows_and_poses(random_release):
    release = random_release(1)
    for run, truth in zip(reader.load(release.root), release.runs, strict=True):
        taken = truth.table[truth.table[:, 18] > 0]
        np.testing.assert_array_equal(run.image_rows.to_numpy(), taken)
        assert [image.number for image in run] == list(range(1, len(taken) + 1))
        for image, row, X_WC, encoded in zip(run.images, taken, truth.X_WC, truth.pictures, strict=True):
            assert image.t_s == row[0] / 1000
            np.testing.assert_array_equal(image.pose, row[1:4])
            np.testing.assert_array_equal(image.X_WC, X_WC)
            expected = cv2.imdecode(np.frombuffer(encoded, np.uint8), cv2.IMREAD_COLOR)
            np.testing.assert_array_equal(image.pixels(), cv2.cvtColor(expected, cv2.COLOR_BGR2RGB))


def test_all_rows_stand_under_each_other_with_their_run(random_release):
    release = random_release(1)
    rows = reader.load(release.root).rows
    for truth in release.runs:
        np.testing.assert_array_equal(rows[rows["run"] == truth.name][list(HEADER)].to_numpy(), truth.table)
    assert len(rows) == sum(len(truth.table) for truth in release.runs)


def test_masks_are_those_of_instances_and_categories(random_release):
    release = random_release(1, annotated=True)
    for run, truth in zip(reader.load(release.root), release.runs, strict=True):
        for image, ids in zip(run.images, truth.instances, strict=True):
            np.testing.assert_array_equal(image.annotation("instance"), ids)
            np.testing.assert_array_equal(image.mask("A10"), ids == 5)
            np.testing.assert_array_equal(image.mask("wall"), (ids == 3) | (ids == 5))
            np.testing.assert_array_equal(image.mask("sky"), ids == 0)
            assert not image.mask("robot").any()


def test_the_folder_of_a_run_and_a_bag_are_read_too(random_release, tmp_path):
    release = random_release(1)
    alone = reader.load(release.root / "CCW/test_1")
    assert (alone.metadata, alone.runs[0].name) == (None, "CCW/test_1")
    np.testing.assert_array_equal(alone.runs[0].rows.to_numpy(), release.runs[1].table)
    (tmp_path / "bagit.txt").write_text("BagIt-Version: 1.0\n")
    shutil.copytree(release.root, tmp_path / "data")
    assert len(reader.load(tmp_path)) == 2


def test_a_run_has_the_title_of_its_scenario_and_a_lone_table_that_of_its_folder(random_release, tmp_path):
    root = random_release(1).root
    assert (reader.load(root).title, reader.load(root / "CW/test_1").title) == ("smoke", "smoke")
    (tmp_path / "mine").mkdir()
    shutil.copy(root / "CW/test_1/data.csv", tmp_path / "mine")
    assert reader.load(tmp_path / "mine").title == "mine"


@pytest.fixture
def copy(random_release, copy_of):
    return copy_of(random_release(1).root)


def damaged(name, text):
    return lambda root: (root / name).write_text(text)


DAMAGE = {
    "no release": (lambda root: (root / "metadata.json").unlink(), "neither a release nor a run"),
    "no JSON": (damaged("metadata.json", "{"), "metadata.json: is damaged"),
    "a run elsewhere": (
        lambda root: (root / "metadata.json").write_text(
            (root / "metadata.json").read_text().replace('"CW/test_1"', '"../CW/test_1"')
        ),
        "leads out of the dataset",
    ),
    "a run twice": (
        lambda root: (root / "metadata.json").write_text(
            (root / "metadata.json").read_text().replace('"CCW/test_1"', '"CW/test_1"')
        ),
        "names the run CW/test_1 twice",
    ),
    "no rows": (lambda root: (root / "CW/test_1/data.csv").unlink(), "CW/test_1/data.csv: is missing"),
    "a row cut off": (
        lambda root: (root / "CW/test_1/data.csv").write_bytes((root / "CW/test_1/data.csv").read_bytes()[:-20]),
        r"data.csv:\d+: \d+ columns?; allowed: 19; restore it with `symolo repair /.*/copy`$",
    ),
    "no picture": (lambda root: (root / "CW/test_1/images/000001.jpg").unlink(), "000001.jpg: is missing"),
    "half a picture": (damaged("CW/test_1/images/000001.jpg", "x"), "000001.jpg: is no image"),
    "other times": (
        damaged("CW/test_1/side/wheels.csv", ",".join(WHEELS.header) + "\n" + ",".join("0" * 16) + "\n"),
        r"wheels.csv: column t is not that of data.csv",
    ),
    "no camera": (lambda root: (root / "CW/test_1/side/camera.csv").unlink(), "camera.csv: cannot be read: No such"),
    "no intrinsics": (damaged("CW/test_1/side/intrinsics.json", "{}"), "intrinsics.json: is damaged: width_px"),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_what_is_wrong_is_said_in_one_line(kind, copy):
    damage, what = DAMAGE[kind]
    damage(copy)

    def read_all():
        for run in reader.load(copy):
            _ = run.rows, run.side("wheels"), run.X_WC, run.camera
            for image in run:
                image.pixels()

    with pytest.raises(reader.InputError, match=what) as refused:
        read_all()
    assert "\n" not in str(refused.value)


def test_a_name_that_is_not_there_is_answered_with_those_that_are(random_release):
    data = reader.load(random_release(1).root)
    run = data.runs[0]
    has_depth = reader.load(random_release(1, kinds=("depth", "boxes_2d")).root).runs[0]
    assert has_depth.annotation_kinds == ("depth",)
    for call, hint in (
        (lambda: data["CW/test_2"], "did you mean CW/test_1"),
        (lambda: run.side("weels"), "did you mean wheels"),
        (lambda: run.image(99), "got 99, allowed: 1 to"),
        (lambda: run.images[0].annotation("instance"), "add `instance` to render.annotations and repeat"),
        (lambda: has_depth.images[0].annotation("instance"), "allowed: depth; add `instance` to render.annotations"),
        (lambda: has_depth.images[0].mask("wall"), "allowed: depth; add `instance` to render.annotations"),
        (lambda: has_depth.images[0].annotation("dept"), "allowed: depth; did you mean depth$"),
        (lambda: has_depth.images[0].mask("wal"), "did you mean wall$"),
        (lambda: has_depth.images[0].mask("x"), "allowed: sky, floor, line, wall, obstacle, room, robot, line_0, A1,"),
        (lambda: data.matching("X*"), r"^no run matches: got 'X\*', allowed: a pattern of names such as CW/test_1,"),
        (lambda: run.images[0].mask("wall"), "has no annotations"),
        (lambda: reader.load("nowhere"), "no such folder"),
    ):
        with pytest.raises(reader.InputError, match=hint):
            call()


def test_tables_load_neither_opencv_nor_an_engine(random_release):
    root = random_release(1).root
    program = (
        f"import json, sys, symolo\ndata = symolo.load({str(root)!r})\n"
        "data.rows, data.runs[0].X_WC, data.runs[0].side('wheels')\nprint(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert "symolo" in loaded
    assert loaded.isdisjoint({"cv2", "bpy", "pybullet", "matplotlib", "torch", "serial"})


def test_frames_for_pytorch_are_the_images_with_their_poses(random_release, monkeypatch):
    """PyTorch is stood in for, by the two names that are used of it."""
    stand_in = types.SimpleNamespace(
        utils=types.SimpleNamespace(data=types.SimpleNamespace(Dataset=object)), from_numpy=lambda array: array
    )
    release = random_release(1)
    data = reader.load(release.root)
    monkeypatch.setitem(sys.modules, "torch", stand_in)
    frames = reader.torch_dataset(data)
    assert len(frames) == sum(len(truth.pictures) for truth in release.runs)
    last, image = frames[len(frames) - 1], data.images[-1]
    assert (last.run, last.t_s, last.image.shape) == ("CCW/test_1", image.t_s, (3, 24, 40))
    np.testing.assert_allclose(last.image * 255, image.pixels().transpose(2, 0, 1), atol=1e-4)
    np.testing.assert_array_equal(last.X_WC, release.runs[1].X_WC[-1])
    sent = pickle.loads(pickle.dumps(frames))  # noqa: S301 - as loaders do for workers that are spawned
    np.testing.assert_array_equal(sent[len(sent) - 1].image, last.image)
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(reader.EnvironmentLacking, match="pip install torch"):
        reader.torch_dataset(data)
