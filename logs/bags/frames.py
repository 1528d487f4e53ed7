"""Poses between two frames, from the transforms of a bag."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from logs.bags.bag import Topic
from symolo.core.arrays import Array
from symolo.core.geometry.poses import quaternions, rotations
from symolo.core.progress import plural

_ROBOT = ("base_footprint", "base_link", "base", "robot")
"""Frames of a robot, of which the first that there is gives the pose (REP 105)."""
_WORLD = ("world", "map", "mocap", "odom")


@dataclass(frozen=True)
class Track:
    """Poses in the order of time."""

    name: str
    """Topic, or frames such as `map:base_link`."""
    parent: str
    child: str
    t_s: Array
    """(N,), since the first message of the bag."""
    values: Array
    """(N, 7 or more), position [m] and quaternion; of odometry, then speed [m/s] and turn [rad/s]."""
    changes: tuple[str, ...] = ()
    """Changes of the data, in one sentence each."""

    @classmethod
    def from_topic(cls, topic: Topic, good: np.ndarray) -> "Track":
        """Return the poses of a topic that are `good` (N,)."""
        stream = topic.stream
        name = topic.frames if stream.type.endswith(("/TFMessage", "/tfMessage")) else stream.topic
        left = f"left out: {plural(np.count_nonzero(~good), 'message')} of {name} without a pose"
        changes = () if good.all() else (left,)
        return cls(name, stream.parent, stream.child, topic.t_s[good], topic.values[good], changes)

    @property
    def is_odometry(self) -> bool:
        return self.values.shape[1] > 7

    @property
    def matrices(self) -> Array:
        """X (N, 4, 4) of the child in the parent."""
        X = np.tile(np.eye(4), (len(self.t_s), 1, 1))
        X[:, :3, :3], X[:, :3, 3] = rotations(self.values[:, 3:7]), self.values[:, :3]
        return X


def pairs(transforms: Sequence[Track]) -> list[str]:
    """Return the names of the transforms that change in time."""
    return [track.name for track in transforms if len(track.t_s) > 1]


def robot_frames(transforms: Sequence[Track]) -> tuple[str, str] | None:
    """Return the frames of the world and of the robot, by their usual names; None where there are none."""
    parents = {_plain(track.child): _plain(track.parent) for track in transforms}
    child = next((frame for frame in _ROBOT if frame in parents), None)
    if child is None:
        return None
    above = _above(child, parents)
    world = next((frame for frame in _WORLD if frame in above), above[-1])
    return world, child


def between(parent: str, child: str, transforms: Sequence[Track]) -> Track | None:
    """Return the poses of a frame in another one through all transforms between them; None where nothing connects them.

    Times are those of the transform with the most messages; of the others the last one before that counts.
    """
    by_child = {_plain(track.child): track for track in transforms if len(track.t_s)}
    chain: list[Track] = []
    frame = _plain(child)
    while frame != _plain(parent):
        track = by_child.get(frame)
        if track is None or track in chain:
            return None
        chain.insert(0, track)
        frame = _plain(track.parent)
    if not chain:
        return None
    leading = max(chain, key=lambda track: len(track.t_s))
    # A transform that is sent once holds for the whole time.
    starts = [track.t_s[0] for track in chain if len(track.t_s) > 1]
    t_s = leading.t_s[leading.t_s >= max(starts, default=-np.inf)]
    X = np.tile(np.eye(4), (len(t_s), 1, 1))
    for track in chain:
        at = np.maximum(np.searchsorted(track.t_s, t_s, side="right") - 1, 0)
        X = X @ track.matrices[at]
    values = np.column_stack((X[:, :3, 3], quaternions(X[:, :3, :3]))) if len(t_s) else np.zeros((0, 7))
    changes = tuple(change for track in chain for change in track.changes)
    return Track(f"{parent}:{child}", parent, child, t_s, values, changes)


def _plain(frame: str) -> str:
    """Return the name of a frame without the slash that ROS 1 allowed in front of it."""
    return frame.lstrip("/")


def _above(child: str, parents: dict[str, str]) -> list[str]:
    """Return the frames above a frame, the nearest first."""
    above: list[str] = []
    while (frame := parents.get(above[-1] if above else child)) is not None and frame not in above:
        above.append(frame)
    return above
