"""A bag of ROS 2 for each run, in MCAP (https://mcap.dev/spec), as rosbag2 stores it; what is in it: `ros_messages`."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from symolo.core.extras import optional_module
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, MadeFile
from symolo.exporters.ros_messages import Vocabulary, about_bytes, messages, topics
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("rosbags.rosbag2")
    for run in data.runs:
        yield MadeFile(f"{run.name}.mcap", lambda run=run: _bag(run), lambda run=run: about_bytes(run))


def _bag(run: Run) -> bytes:
    """The library writes a folder; of it the bag itself, which holds the other file's content, too."""
    rosbag2, typesys = optional_module("rosbags.rosbag2"), optional_module("rosbags.typesys")
    # Of Jazzy, whose sensor_msgs/Range has a field more than older ones: who expects less reads it, not so the reverse.
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    name = run.folder.name
    with TemporaryDirectory(prefix="symolo-", ignore_cleanup_errors=True) as scratch:
        folder = Path(scratch) / name
        with rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as bag:
            profiles = {topic.name: [_kept_for_who_comes_later()] if topic.latched else [] for topic in topics(run)}
            connections = {
                topic.name: bag.add_connection(
                    topic.name, topic.type, typestore=store, offered_qos_profiles=profiles[topic.name]
                )
                for topic in topics(run)
            }
            for topic, at_ns, message in messages(run, Vocabulary(store, 2)):
                bag.write(connections[topic.name], at_ns, store.serialize_cdr(message, topic.type))
        return (folder / f"{name}.mcap").read_bytes()


def _kept_for_who_comes_later() -> object:
    """Quality of service of /tf_static: reliable, transient local, the last one kept."""
    of = optional_module("rosbags.interfaces")
    no_limit = of.QosTime(0, 0)
    return of.Qos(
        history=of.QosHistory.KEEP_LAST,
        depth=1,
        reliability=of.QosReliability.RELIABLE,
        durability=of.QosDurability.TRANSIENT_LOCAL,
        deadline=no_limit,
        lifespan=no_limit,
        liveliness=of.QosLiveliness.SYSTEM_DEFAULT,
        liveliness_lease_duration=no_limit,
        avoid_ros_namespace_conventions=False,
    )


EXPORTER = Exporter("mcap", "a bag of ROS 2 for each run: pictures, readings, odometry, transforms", _files)
