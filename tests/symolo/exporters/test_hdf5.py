"""By h5py alone, decoded as docs/annotations.md says and as BlenderProc documents and writes its own."""

import json
import re
from pathlib import Path

import cv2
import h5py
import numpy as np

from symolo.dataset.tables.rows import HEADER
from symolo.dataset.tables.side_tables import TOF, WHEELS

FAR = np.float32(1e10)
"""What Blender writes where nothing is met."""
SHOWN = ["colors", "normals", "diffuse", "nocs", "forward_flow", "backward_flow", "segmap", ".*_segmaps", "depth"]
"""What `blenderproc vis hdf5` draws (2.8.0)."""


def decoded(file, index, truth):
    """Images of annotations of the file as they should be, from what was stored."""
    stored = {kind: pictures[index] for kind, pictures in truth.passes.items() if index < len(pictures)}
    ids = truth.instances[index]
    expected = {"instance_segmaps": ids, "depth": np.where(stored["depth"] > 0, stored["depth"] / 10_000, FAR)}
    normal = (stored["normals"].astype(float) - 32768) / 32767
    right_up_back = normal * (1, -1, -1)
    nothing = np.all(stored["normals"] == 0, axis=-1, keepdims=True)
    expected["normals"] = np.where(nothing, 0.5, right_up_back / 2 + 0.5)
    expected["free_floor_segmaps"] = stored["free_floor"] / 255
    if "semantic" in stored:
        expected["category_id_segmaps"] = stored["semantic"]
    if "flow" in stored:
        flow = stored["flow"].astype(float)
        expected["forward_flow_valid"] = flow[..., 2]
        expected["forward_flow"] = (flow[..., :2] - 32768) / 64 * flow[..., 2:]
    assert {*file} == {*expected, "colors", "camera_pose", "row", "instance_attribute_maps"}
    return expected


def check_frame(path, index, truth):
    with h5py.File(path) as file:
        pixels = cv2.imdecode(np.frombuffer(truth.pictures[index], np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        np.testing.assert_array_equal(file["colors"], pixels)
        for name, expected in decoded(file, index, truth).items():
            np.testing.assert_allclose(file[name], expected, rtol=1e-6, atol=1e-6)
            assert name == "forward_flow_valid" or any(re.fullmatch(pattern, name) for pattern in SHOWN)
        listed = json.loads(np.array(file["instance_attribute_maps"]).tobytes())
        known = {0: ("sky", 0), 1: ("floor", 1), 2: ("line_0", 2), 3: ("A1", 3), 4: ("O1", 4), 5: ("A10", 3)}
        entries = {one["idx"]: (one["name"], one["category_id"]) for one in listed}
        assert entries == {one: known[one] for one in np.unique(truth.instances[index]).tolist()}
        camera = json.loads(np.array(file["camera_pose"]).tobytes())
        R_CW, p_CW = np.reshape(camera["cam_R_w2c"], (3, 3)), np.array(camera["cam_t_w2c"])
        X_WC = truth.X_WC[index]
        np.testing.assert_allclose(R_CW, X_WC[:3, :3].T, atol=1e-8)
        np.testing.assert_allclose(R_CW @ X_WC[:3, 3] + p_CW, 0, atol=1e-6)
        np.testing.assert_array_equal(np.reshape(camera["cam_K"], (3, 3)), truth.K)
        row = json.loads(np.array(file["row"]).tobytes())
        assert [row[name] for name in HEADER] == truth.table[truth.table[:, 18] > 0][index].tolist()


def test_hdf5_holds_the_release(seed, random_release, exported, tmp_path):
    release = random_release(seed, annotated=True)
    out = exported(release.root, tmp_path / "out", "hdf5") / "hdf5"
    with h5py.File(out / "tables.hdf5") as file:
        for truth in release.runs:
            tables = (("rows", HEADER, truth.table), ("wheels", WHEELS.header, truth.wheels))
            for name, header, expected in (*tables, ("tof", TOF.header, truth.tof)):
                group = file[f"{truth.name}/{name}"]
                assert {*group} == {*header}
                np.testing.assert_array_equal(np.column_stack([group[column] for column in header]), expected)
            assert file[f"{truth.name}/rows/w"].attrs["unit"] == "rad/s"
    for truth in release.runs:
        folder = out / truth.name
        assert {path.name for path in folder.iterdir()} == {f"{i}.hdf5" for i in range(len(truth.pictures))}
        for index in range(len(truth.pictures)):
            check_frame(folder / f"{index}.hdf5", index, truth)


def test_a_release_without_annotations_has_colours_poses_and_rows(random_release, exported, tmp_path):
    out = exported(random_release(1).root, tmp_path / "out", "hdf5")
    with h5py.File(Path(out) / "hdf5/CW/test_1/0.hdf5") as file:
        assert {*file} == {"colors", "camera_pose", "row"}
