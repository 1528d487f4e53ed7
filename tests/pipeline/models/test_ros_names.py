"""The files of a robot and the bags of its runs name and place the same frames, so that ROS shows them together."""

import numpy as np
import pytest
import yourdfpy
from rosbags.rosbag1 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from pipeline.cli import main
from pipeline.models.files import model_files
from pipeline.run_folder.stored_spec import read_simulated_spec
from symolo.core.geometry.poses import rotations

RUN = "CW/test_1"


@pytest.fixture(scope="module")
def urdf(sensing_release, tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "robot.urdf"
    spec = read_simulated_spec(sensing_release / RUN / "side/spec.json")
    path.write_bytes(model_files(spec, ("urdf",))["robot.urdf"])
    return yourdfpy.URDF.load(str(path))


@pytest.fixture(scope="module")
def messages(sensing_release, tmp_path_factory):
    """Messages by topic, as a reader of ROS 1 decodes them."""
    out = tmp_path_factory.mktemp("bag") / "out"
    assert main(["export", str(sensing_release), "--format", "ros1", "--out", str(out)]) == 0
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    messages = {}
    with Reader(out / f"ros1/{RUN}.bag") as reader:
        for connection, _, raw in reader.messages():
            message = store.deserialize_ros1(raw, connection.msgtype)
            messages.setdefault(connection.topic, []).append(message)
    return messages


@pytest.mark.filterwarnings("ignore:.*dump.concatenate=True:DeprecationWarning")  # of trimesh, at yourdfpy's way
def test_each_frame_of_tf_is_a_link_at_the_same_place(urdf, messages):
    (static,) = messages["/tf_static"]
    assert len(static.transforms) > 10
    for one in static.transforms:
        place, turn = one.transform.translation, one.transform.rotation
        X = np.eye(4)
        X[:3, :3] = rotations(np.array([[turn.x, turn.y, turn.z, turn.w]]))[0]
        X[:3, 3] = place.x, place.y, place.z
        expected = urdf.get_transform(one.child_frame_id, one.header.frame_id)
        np.testing.assert_allclose(X, expected, atol=1e-6, err_msg=one.child_frame_id)
    (moving, *_) = messages["/tf"]
    assert moving.transforms[-1].child_frame_id == urdf.base_link


@pytest.mark.filterwarnings("ignore:.*dump.concatenate=True:DeprecationWarning")  # of trimesh, at yourdfpy's way
def test_joint_states_name_the_joints_that_move(urdf, messages):
    assert {*messages["/joint_states"][0].name} == {*urdf.actuated_joint_names}
    assert {*messages["/sensors/coder"][0].name} <= {*urdf.actuated_joint_names}
