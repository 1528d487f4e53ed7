"""A bag of ROS 2 for each run, in MCAP (https://mcap.dev/spec) as from rosbag2; `ros` makes the content."""

from collections.abc import Iterator

from symolo.core.extras import optional_module
from symolo.core.files.scratch_folders import scratch_folder
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.ros.messages import estimated_bytes, messages, topics
from symolo.exporters.ros.vocabulary import Vocabulary
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("rosbags.rosbag2")
    for run in data.runs:
        yield ExportedFile(f"{run.name}.mcap", lambda run=run: _bag(run), lambda run=run: estimated_bytes(run))


def _bag(run: Run) -> bytes:
    """Return only the bag of the folder that the library writes; it also contains the content of the other file."""
    rosbag2, typesys = optional_module("rosbags.rosbag2"), optional_module("rosbags.typesys")
    # sensor_msgs/Range of Jazzy has one more field than that of older releases. A reader that expects fewer fields can
    # read such messages; a reader that expects more fields could not read the shorter ones.
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    name = run.folder.name
    with scratch_folder() as scratch:
        folder = scratch / name
        with rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as bag:
            connections = {
                topic.name: bag.add_connection(
                    topic.name,
                    topic.type,
                    typestore=store,
                    offered_qos_profiles=[_latched_profile()] if topic.latched else [],
                )
                for topic in topics(run)
            }
            for topic, at_ns, message in messages(run, Vocabulary(store, 2)):
                bag.write(connections[topic.name], at_ns, store.serialize_cdr(message, topic.type))
        return (folder / f"{name}.mcap").read_bytes()


def _latched_profile() -> object:
    """Return the quality of service of /tf_static: late subscribers get the last message."""
    interfaces = optional_module("rosbags.interfaces")
    no_limit = interfaces.QosTime(0, 0)
    return interfaces.Qos(
        history=interfaces.QosHistory.KEEP_LAST,
        depth=1,
        reliability=interfaces.QosReliability.RELIABLE,
        durability=interfaces.QosDurability.TRANSIENT_LOCAL,
        deadline=no_limit,
        lifespan=no_limit,
        liveliness=interfaces.QosLiveliness.SYSTEM_DEFAULT,
        liveliness_lease_duration=no_limit,
        avoid_ros_namespace_conventions=False,
    )


EXPORTER = Exporter("mcap", "a bag of ROS 2 for each run: images, readings, odometry, transforms", _files)
