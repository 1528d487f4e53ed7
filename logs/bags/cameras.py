"""Cameras of a bag: images of a topic, with the lens of its sensor_msgs/CameraInfo and the place that tf gives it."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from logs.bags.bag import Bag, ImageTopic, Topic
from logs.bags.frames import Track
from logs.bags.images import COMPRESSED, QUALITY
from logs.bags.sensors import mount_settings, pose_on_robot, sensor_name
from logs.bags.streams import LENS
from logs.times import usual_step
from logs.trajectories.base import LoggedCamera
from symolo.core.arrays import Array
from symolo.core.files.image_headers import JPEG
from symolo.core.progress import plural
from symolo.dataset.documents.camera_model import X_CB
from symolo.dataset.pixels import decoded_contents

_LENSES = {"plumb_bob": 5, "equidistant": 4, "fisheye": 4}
"""Number of coefficients of each model of distortion."""


@dataclass(frozen=True)
class BagCameras:
    """The cameras of a bag."""

    cameras: tuple[LoggedCamera, ...]
    topics: dict[str, str]
    """Topic, number and size of the images by the name of the camera."""
    notes: tuple[str, ...]
    """Changes and omissions, in one sentence each."""


class _LeftOutError(Exception):
    """The images of a topic cannot be taken; the text says why."""


def cameras_of(bag: Bag, robot_frame: str, transforms: Sequence[Track], taken: Sequence[str]) -> BagCameras:
    """Return the cameras of a bag.

    Args:
        bag: The bag.
        robot_frame: Frame of the robot whose poses are read; empty if it is not known.
        transforms: Transforms of tf, from which the places of the cameras on the robot follow.
        taken: Names of the other sensors.
    """
    cameras, topics, notes = [], {}, []
    by_place: dict[str, str] = {}
    # Compressed images come first, because JPEG files stay as they are.
    for images in sorted(bag.images, key=lambda one: (one.type != COMPRESSED, one.topic)):
        place = _place(images.topic)
        name = sensor_name(place or "/camera", (*taken, *topics))
        same = f"it is the camera of {by_place[place]}" if place in by_place else ""
        try:
            camera, changes = _camera(images, name, _lens(bag, place, images.problem or same), robot_frame, transforms)
        except _LeftOutError as error:
            notes.append(f"left out: {images.topic}: {error}")
            continue
        by_place[place] = images.topic
        count = plural(len(camera.files), "image")
        topics[name] = f"{images.topic}: {count} of {camera.size[0]} x {camera.size[1]} px"
        cameras.append(camera)
        notes += changes
    return BagCameras(tuple(cameras), topics, tuple(notes))


def is_lens(topic: Topic) -> bool:
    return topic.stream.columns[: len(LENS)] == LENS


def _place(topic: str) -> str:
    """Return the name space of a camera: `/camera` for `/camera/image_raw/compressed` and `/camera/image_raw`."""
    return topic.removesuffix("/compressed").rpartition("/")[0]


def _lens(bag: Bag, place: str, problem: str) -> Topic:
    """Return the messages about the lens of a camera.

    Raises:
        _LeftOutError: There are none, or its images have a problem.
    """
    if problem:
        raise _LeftOutError(problem)
    lenses = [topic for topic in bag.topics if topic.stream.topic == f"{place}/camera_info"]
    if not lenses:
        raise _LeftOutError(f"there is no {place}/camera_info, so its lens is not known")
    return max(lenses, key=lambda topic: len(topic.t_s))


def _camera(
    images: ImageTopic, name: str, lens: Topic, robot_frame: str, transforms: Sequence[Track]
) -> tuple[LoggedCamera, list[str]]:
    """Return a camera, and what was changed.

    Raises:
        _LeftOutError: Its lens or its place cannot be described, or no image can be decoded.
    """
    width_px, height_px = (int(lens.column(one)[0]) for one in LENS[:2])
    K = np.array([lens.column(one)[0] for one in LENS[2:]]).reshape(3, 3)
    model = lens.stream.child or "plumb_bob"
    D = tuple(lens.values[0, len(LENS) :].tolist())
    if model not in _LENSES or len(D) > _LENSES[model]:
        known = "plumb_bob with up to 5 coefficients, and equidistant"
        raise _LeftOutError(f"its lens has the model {model!r} with {len(D)} coefficients; known are {known}")
    if min(K[0, 0], K[1, 1]) <= 0 or K[0, 1] or not np.isfinite(lens.values[0]).all():
        raise _LeftOutError(f"{lens.stream.topic} has no camera matrix, as of a camera that is not calibrated")
    X_RC = pose_on_robot(images.frame, robot_frame, transforms)
    if isinstance(X_RC, str):
        raise _LeftOutError(X_RC)
    files, changes = _files(images, (width_px, height_px))
    good = [number for number, file in enumerate(files) if file]
    if not good:
        raise _LeftOutError(f"no image can be decoded with the {width_px} x {height_px} px of {lens.stream.topic}")
    if len(good) < len(files):
        count = plural(len(files) - len(good), "image")
        changes.append(f"{name}: left out: {count} of another size than {width_px} x {height_px} px, or damaged")
    camera = LoggedCamera(
        name,
        images.t_s[good],
        tuple(files[number] for number in good),
        (width_px, height_px),
        K,
        "plumb_bob" if model == "plumb_bob" else "equidistant",
        (*D, *[0.0] * (_LENSES[model] - len(D))),
        {"period_s": _period_s(images.t_s[good]), "delay_s": 0.0, **mount_settings(X_RC @ np.array(X_CB))},
    )
    return camera, [f"{name}: {text}" if not text.startswith(name) else text for text in changes]


def _period_s(t_s: Array) -> float:
    """Return the usual time between two images, 1 s if there is one image."""
    return max(round(usual_step(np.diff(t_s)), 6), 0.001) if len(t_s) > 1 else 1.0


def _files(images: ImageTopic, size: tuple[int, int]) -> tuple[list[bytes], list[str]]:
    """Return a JPEG file in colour for each image, empty for one that cannot be decoded, and what was changed."""
    files = []
    encoded = 0
    for data, pixels in zip(images.files, decoded_contents(images.files, size=size), strict=True):
        if pixels is None or pixels.dtype != np.uint8 or (pixels.ndim == 3 and pixels.shape[2] not in {1, 3, 4}):
            files.append(b"")
        elif pixels.ndim == 3 and pixels.shape[2] == 3 and data.startswith(JPEG):
            files.append(data)
        else:
            colour = pixels[..., :3] if pixels.ndim == 3 else np.repeat(pixels[..., None], 3, axis=2)
            done, content = cv2.imencode(".jpg", np.ascontiguousarray(colour), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
            files.append(content.tobytes() if done else b"")
            encoded += 1
    if encoded or images.type != COMPRESSED:
        return files, [f"images are stored as colour JPEG files of quality {QUALITY}"]
    return files, []
