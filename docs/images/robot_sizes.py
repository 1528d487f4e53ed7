"""The shipped robots of three sizes beside each other."""

import cv2
import numpy as np

from blender_scenes.materials.fittings import moulded
from blender_scenes.preview.rasteriser import rasterise
from blender_scenes.preview.triangles import Triangles
from blender_scenes.scene.meshes import block
from blender_scenes.scene.robot_body import robot_body, robot_surfaces
from blender_scenes.scene.typical import typical_color
from configs.draw import draw_robot
from configs.loader import load_section
from symolo.core.geometry.pinhole import Intrinsics
from symolo.core.geometry.poses import pose_X_WR


def robots_beside_each_other() -> np.ndarray:
    """Return an image (380, 900, 3) of the robots on one floor, each on the line of its arena, as BGR."""
    nominal, _ = draw_robot(load_section("robot", "nominal"), 1, "image")
    surfaces = [
        *robot_surfaces(nominal),
        moulded("floor", (0.75, 0.75, 0.72), 0.5),
        moulded("line", (0.01, 0.01, 0.01), 0.5),
    ]
    numbers = {surface.name: number for number, surface in enumerate(surfaces)}
    meshes, labels, x_m = (
        [Triangles.from_meshes((block("floor", (0.0, 0.0, -0.01), (4.0, 4.0, 0.02), "floor"),), numbers)],
        [],
        -0.4,
    )
    for name, line_m in (("micromouse", 0.0075), ("nominal", 0.015), ("scout", 0.0292)):
        robot, _ = draw_robot(load_section("robot", name), 1, "image")
        x_m += 0.5 * robot.chassis.width_m
        place = pose_X_WR(x_m, 0.0, -0.5 * np.pi)
        line = block("line", (0.0, 0.0, 0.0), (3.0, line_m, 0.001), "line")
        meshes.append(Triangles.from_meshes((*robot_body(robot), line), numbers).placed(place))
        labels.append((x_m, f"{name}, {100 * robot.chassis.length_m:.0f} cm"))
        x_m += 0.5 * robot.chassis.width_m + 0.09
    camera, X_WC = (
        Intrinsics(1800, 760, 1500.0, 1500.0, 899.5, 379.5),
        _view_from((0.1, -1.15, 0.62), (0.02, -0.03, 0.06)),
    )
    triangles = Triangles.joined(meshes)
    seen = rasterise(camera, X_WC, triangles).triangle
    colours = np.array([typical_color(surface) for surface in surfaces])[triangles.surface]
    light = 0.45 + 0.55 * np.abs(triangles.normals @ np.array([0.45, -0.3, 0.84]))
    shown = np.clip(2.0 * colours * light[:, None], 0.0, 1.0)[seen] ** (1 / 2.2)
    small = cv2.resize((255 * shown[..., ::-1]).astype(np.uint8), (900, 380), interpolation=cv2.INTER_AREA)
    for x_m, label in labels:
        u, v, depth = np.linalg.inv(X_WC)[:3] @ (x_m, -0.36, 0.0, 1.0)
        at = (round(0.5 * (1500.0 * u / depth + 900.0)) + 22, round(0.5 * (1500.0 * v / depth + 380.0)))
        cv2.putText(small, label, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, (60, 60, 60), 1, cv2.LINE_AA)
    return small


def _view_from(eye: tuple[float, float, float], target: tuple[float, float, float]) -> np.ndarray:
    """Return the pose (4, 4) of a level camera, x right, y down, z forward."""
    forward = np.subtract(target, eye)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3] = np.stack([right, np.cross(forward, right), forward, eye], axis=1)
    return pose
