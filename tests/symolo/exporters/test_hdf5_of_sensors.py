"""HDF5 files of a release with further cameras and sensors, by h5py alone."""

import json

import cv2
import h5py
import numpy as np


def test_further_cameras_have_files_and_tables_of_their_own(sensing_release, exported, tmp_path):
    folder = exported(sensing_release, tmp_path / "out", "hdf5") / "hdf5"
    run = sensing_release / "CW/test_1"
    with h5py.File(folder / "tables.hdf5") as file:
        for name in ("imu", "lidar", "bumper"):
            table = np.genfromtxt(run / f"side/{name}.csv", delimiter=",", names=True)
            assert {*file[f"CW/test_1/{name}"]} == {*table.dtype.names}
            for column in table.dtype.names:
                np.testing.assert_array_equal(file[f"CW/test_1/{name}/{column}"], table[column])
        poses = np.genfromtxt(run / "cameras/rear/side/camera.csv", delimiter=",", names=True)
        np.testing.assert_array_equal(file["CW/test_1/cameras/rear/p_x"], poses["p_x"])
    for name in ("left", "rear"):
        jpeg = run / f"cameras/{name}/images/000002.jpg"
        with h5py.File(folder / f"CW/test_1/cameras/{name}/1.hdf5") as file:
            np.testing.assert_array_equal(file["colors"], cv2.imread(str(jpeg))[..., ::-1])
            pose = json.loads(np.array(file["camera_pose"]).tobytes())
        model = json.loads((run / f"cameras/{name}/side/intrinsics.json").read_text())
        np.testing.assert_array_equal(np.reshape(pose["cam_K"], (3, 3)), model["K"])
