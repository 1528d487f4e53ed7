"""A bag of ROS 1 for each run (https://wiki.ros.org/Bags/Format/2.0); `ros` makes the content."""

from collections.abc import Iterator

from symolo.core.extras import optional_module
from symolo.core.files.scratch_folders import scratch_folder
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.ros.messages import estimated_bytes, messages, topics
from symolo.exporters.ros.vocabulary import Vocabulary
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("rosbags.rosbag1")
    for run in data.runs:
        yield ExportedFile(f"{run.name}.bag", lambda run=run: _bag(run), lambda run=run: estimated_bytes(run))


def _bag(run: Run) -> bytes:
    rosbag1, typesys = optional_module("rosbags.rosbag1"), optional_module("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
    # The library's message types of Noetic lack those of tf2.
    store.register(typesys.get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    with scratch_folder() as scratch:
        path = scratch / "run.bag"
        with rosbag1.Writer(path) as bag:
            connections = {
                topic.name: bag.add_connection(
                    topic.name, topic.type, typestore=store, latching=1 if topic.latched else None
                )
                for topic in topics(run)
            }
            for topic, at_ns, message in messages(run, Vocabulary(store, 1)):
                bag.write(connections[topic.name], at_ns, store.serialize_ros1(message, topic.type))
        return path.read_bytes()


EXPORTER = Exporter("ros1", "a bag of ROS 1 for each run, with the same messages as the bag of ROS 2", _files)
