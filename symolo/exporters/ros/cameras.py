"""Images of the cameras of a run, and their lenses."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from symolo.core.arrays import Array
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.sensor_sections import optical_frame, sensor_frame
from symolo.exporters.ros.topic import Log, Stamped, Topic
from symolo.exporters.ros.vocabulary import BASE, START_NS, Vocabulary
from symolo.exporters.shared.stereo import OWN_CAMERA, cameras_with_images, stereo_pair
from symolo.reader.camera_run import CameraRun
from symolo.reader.run import Run
from symolo.reader.run_folder import Image, RunFolder


def camera_topics(run: Run) -> Iterator[Topic]:
    """Yield the topics of each camera with images: `/camera/...`, and `/sensors/<name>/...` of a further one."""
    for name, camera in cameras_with_images(run).items():
        place = "/camera" if name == OWN_CAMERA else f"/sensors/{name}"
        infos, images = partial(_infos, run, name, camera), partial(_images, name, camera)
        yield Topic(f"{place}/camera_info", "sensor_msgs/msg/CameraInfo", infos)
        yield Topic(f"{place}/image_raw/compressed", "sensor_msgs/msg/CompressedImage", images)


def camera_poses(run: Run) -> Iterator[tuple[str, str, Array]]:
    """Yield parent, child and pose (4, 4) of the two frames of each camera."""
    for name, camera in cameras_with_images(run).items():
        body, optical = _frames(name)
        X_CB = camera.camera.X_CB
        yield BASE, body, camera.camera.X_RC @ X_CB
        yield body, optical, np.linalg.inv(X_CB)


def _frames(name: str) -> tuple[str, str]:
    """Return the name of the frame with the axes of a body (x forward), and of that with the axes of an image."""
    if name == OWN_CAMERA:
        return "camera_link", "camera_optical_frame"
    return sensor_frame(name), optical_frame(name)


def _images(name: str, camera: RunFolder, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    for image, at_ns, header in _shutters(name, camera, ros):
        content = np.frombuffer(read_file(image.path, FileKind.IMAGE), dtype=np.uint8)
        yield at_ns, ros("sensor_msgs/CompressedImage", header, "jpeg", content)


def _infos(run: Run, name: str, camera: RunFolder, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    model, pair = camera.camera, stereo_pair(run)
    K, D = model.K, model.D
    P = np.column_stack((K, np.zeros(3)))
    if pair is not None and name == pair.right:
        P[0, 3] = -K[0, 0] * pair.baseline_m
    full_image = ros("sensor_msgs/RegionOfInterest", 0, 0, 0, 0, False)  # noqa: FBT003 - a field of the message
    for _image, at_ns, header in _shutters(name, camera, ros):
        size, unbinned = (model.height_px, model.width_px), (0, 0)
        matrices = D, K.ravel(), np.eye(3).ravel(), P.ravel()
        fields = *size, model.distortion_model, *matrices, *unbinned, full_image
        yield at_ns, ros("sensor_msgs/CameraInfo", header, *fields)


def _shutters(name: str, camera: RunFolder, ros: Vocabulary) -> Iterator[tuple[Image, int, Any]]:
    """Yield image, time in the bag [ns] and header."""
    delay_ns = round(1e9 * camera.settings.delay_s) if isinstance(camera, CameraRun) else 0
    for image in camera.images:
        at_ns = START_NS + int(camera.image_table.t_ms[image.index]) * 1_000_000
        yield image, at_ns + delay_ns, ros.header(at_ns, _frames(name)[1], image.index)
