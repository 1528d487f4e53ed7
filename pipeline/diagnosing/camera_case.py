"""The images of a run on disk as a case for camera identification."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from blender_scenes.render.job import FramePose
from configs.schema.scenario import RunSpec, SceneSpec
from diagnosis.camera.case import HELD_OUT_EACH, CameraCase, CameraFrame, ImagePixels, PoseErrors
from pipeline.run_folder.stored_runs import run_name
from pipeline.run_folder.stored_spec import read_spec
from pipeline.stages.render import IMAGES, Appearance, frame_poses
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.core.files.paths import check_folder
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.robot_path import RobotPath
from symolo.core.progress import plural
from symolo.dataset.layout import DATA, SIDE, SPEC, frame_name
from symolo.dataset.pixels import decoded_bytes
from symolo.dataset.tables.camera_rows import main_camera_rows
from symolo.dataset.tables.rows import Rows, read_rows

MAX_FRAMES = 60
"""Largest number of images of a run, evenly spread; more add little information."""
MIN_FRAMES = 6
SAME_PLACE_M, SAME_YAW_RAD = 0.003, 0.01
"""Largest differences of position [m] and heading [rad] between two images of the same place."""


@dataclass(frozen=True)
class _RunImages:
    folder: Path
    rows: Rows
    spec: SceneSpec | None

    @property
    def poses(self) -> tuple[FramePose, ...]:
        """Pose of the robot at each image."""
        rates = self.spec.rates if isinstance(self.spec, RunSpec) else None
        return frame_poses(main_camera_rows(self.rows, rates))


def read_camera_case(run: Path, simulated: Path | None, pose_errors: PoseErrors) -> CameraCase:
    """Read the images of `run` and those of the simulation with which they are compared.

    Args:
        run: Folder with data.csv and images.
        simulated: Run folder of a dataset with the nominal robot, look and arena in its specification, and images of
            the same places where there are any; None where `run` has a specification itself.
        pose_errors: Errors of the poses in `run`.

    Raises:
        InputError: Something is missing, damaged, or does not fit.
    """
    real = _run(run)
    nominal = real if simulated is None else _run(simulated)
    spec = _nominal_spec(nominal)
    poses = real.poses
    if len(poses) < MIN_FRAMES:
        raise InputError(
            "data.csv",
            where=str(real.folder),
            got=f"{plural(len(poses), 'row')} with an image",
            allowed=f"at least {MIN_FRAMES}",
            cure="give a longer run",
        )
    frames = _frames(real, poses, nominal.folder, {} if simulated is None else _same_places(poses, nominal))
    path = RobotPath(real.rows.t_ms / 1000, real.rows.pose, real.rows.twist)
    arena = Arena.from_config(spec.arena)
    response = Appearance.from_spec(spec).job(arena, poses, path).response
    return CameraCase(run_name(real.folder), frames, path, arena, spec.robot, spec.look, response, pose_errors)


def _nominal_spec(nominal: _RunImages) -> SceneSpec:
    """Return the specification of the nominal robot, look and arena.

    Raises:
        InputError: There is none, or its camera cannot be identified.
    """
    if nominal.spec is None:
        raise InputError(
            "has no side/spec.json, which describes the nominal camera, look and arena",
            where=str(nominal.folder),
            cure="name a run of a dataset by --simulated",
        )
    if nominal.spec.robot.camera.fisheye is not None:
        raise InputError(
            "the camera has a fisheye lens, and only pinhole cameras are identified",
            where=str(nominal.folder),
            cure="use calibration software for fisheye lenses",
        )
    return nominal.spec


def _frames(
    real: _RunImages, poses: Sequence[FramePose], simulated: Path, same_place: Mapping[int, int]
) -> tuple[CameraFrame, ...]:
    """Return evenly spread images of the real run, each with the simulated image of the same place, if there is one.

    Args:
        real: The real run.
        poses: Pose of the robot at each image.
        simulated: Folder of the simulated run.
        same_place: Numbers of simulated images by those of the real images of the same place.
    """
    chosen = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), MAX_FRAMES)).round().astype(int)).tolist()
    frames: list[CameraFrame] = []
    for k, pose in enumerate(poses[i] for i in chosen):
        file = real.folder / IMAGES / frame_name(pose.number)
        image = _read_image(file)
        if frames and image.shape != frames[0].image.shape:
            raise _other_size(file, image, frames[0].image)
        simulated_image = None
        if (number := same_place.get(pose.number)) is not None:
            path = simulated / IMAGES / frame_name(number)
            simulated_image = _read_image(path)
            if simulated_image.shape != image.shape:
                raise _other_size(path, simulated_image, image)
        is_held_out = k % HELD_OUT_EACH == HELD_OUT_EACH - 1
        frames.append(CameraFrame(pose.number, pose.t_s, image, simulated_image, is_held_out))
    return tuple(frames)


def _run(path: Path) -> _RunImages:
    folder = path.parent if path.name == DATA else path
    check_folder(folder, "name a run folder, with data.csv and images", where=str(path))
    if not (folder / IMAGES).is_dir():
        raise InputError(f"has no folder {IMAGES}", where=str(folder), cure="name a run whose images are rendered")
    spec = folder / SIDE / SPEC
    return _RunImages(folder, read_rows(folder / DATA), read_spec(spec) if spec.is_file() else None)


def _same_places(poses: Sequence[FramePose], nominal: _RunImages) -> dict[int, int]:
    """Return the number of the simulated image with the same pose for each measured image.

    Raises:
        InputError: No simulated image has the pose of a measured one.
    """
    theirs = nominal.poses
    places = np.array([(p.x_m, p.y_m) for p in theirs]).reshape(-1, 2)
    yaws = np.array([p.yaw_rad for p in theirs])
    matches: dict[int, int] = {}
    for pose in poses:
        if not len(places):
            break
        turned = np.abs((yaws - pose.yaw_rad + np.pi) % (2 * np.pi) - np.pi)
        away = np.hypot(places[:, 0] - pose.x_m, places[:, 1] - pose.y_m)
        nearest = int(np.argmin(away + turned))
        if away[nearest] < SAME_PLACE_M and turned[nearest] < SAME_YAW_RAD:
            matches[pose.number] = theirs[nearest].number
    if not matches:
        raise InputError(
            "none of its images is of the same place as one of the measured run",
            where=f"--simulated {nominal.folder}",
            cure="rerender the measured run's data.csv with the nominal robot and name that dataset's run",
        )
    return matches


def _read_image(path: Path) -> ImagePixels:
    try:
        data = read_file(path, FileKind.IMAGE)
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}", where=str(path), cure="give every image of data.csv"
        ) from None
    image = decoded_bytes(data, in_colour=True)
    if image is None:
        raise InputError("is no image", where=str(path), cure="replace it, or take its number out of data.csv")
    return np.ascontiguousarray(image[..., ::-1]).astype(np.uint8)


def _other_size(path: Path, image: ImagePixels, other: ImagePixels) -> InputError:
    sizes = [f"{pixels.shape[1]} x {pixels.shape[0]} px" for pixels in (image, other)]
    return InputError("size", where=str(path), got=sizes[0], allowed=f"{sizes[1]}, as the others have")
