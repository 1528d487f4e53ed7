"""Key points in the image: along the middle of the line, and the corners of walls and obstacles."""

import numpy as np

from blender_scenes.annotations.instances import ON_THE_FLOOR
from blender_scenes.annotations.occlusion import hidden, triangles
from blender_scenes.annotations.visible_scene import VisibleScene
from symolo.core.arrays import Array, triple
from symolo.core.geometry.pinhole import project
from symolo.core.geometry.poses import pose_X_WR
from symolo.dataset.annotations import KeyPointSighting

_PIXEL_DECIMALS, _METRE_DECIMALS = 4, 9


def key_points(seen: VisibleScene) -> tuple[KeyPointSighting, ...]:
    """Return the key points within the image, hidden or not."""
    job, X_WC = seen.job, seen.X_WC
    if not job.key_points:
        return ()
    poses = {point.instance_id: seen.pose_X_WI(point.instance_id) for point in job.key_points}
    points_W = np.array([(poses[point.instance_id] @ (*point.p, 1.0))[:3] for point in job.key_points])
    pixels, depth = project(job.camera, X_WC, points_W)
    size = job.camera.width_px, job.camera.height_px
    within = np.flatnonzero((depth > 0) & np.all((pixels >= -0.5) & (pixels < np.array(size) - 0.5), axis=1))
    points_C = (points_W - X_WC[:3, 3]) @ X_WC[:3, :3]
    covered = hidden(points_C[within], (_screens_W(seen) - X_WC[:3, 3]) @ X_WC[:3, :3])
    return tuple(
        KeyPointSighting(
            image_id=seen.view.number,
            key_point_id=job.key_points[i].id,
            pixel=(round(float(pixels[i, 0]), _PIXEL_DECIMALS), round(float(pixels[i, 1]), _PIXEL_DECIMALS)),
            p_C=triple(np.round(points_C[i], _METRE_DECIMALS) + 0.0),
            visible=not covers,
        )
        for i, covers in zip(within.tolist(), covered.tolist(), strict=True)
    )


def _screens_W(seen: VisibleScene) -> Array:
    """Return the triangles (T, 3, 3) in W that can hide something: all that the camera sees but floor and line."""
    scene, instances = seen.job.scene, seen.job.instances
    categories = [instances.known[instance - 1].category for instance in instances.of_mesh[1 : len(scene.meshes) + 1]]
    screens = [
        triangles(mesh) for mesh, category in zip(scene.meshes, categories, strict=True) if category not in ON_THE_FLOOR
    ]
    on_robot = [(mesh, seen.view.robot_pose) for mesh in scene.robot_in_sight]
    for mesh, pose in (*on_robot, *zip(scene.moving, seen.view.moving, strict=True)):
        X_WI = pose_X_WR(*pose)
        screens.append(triangles(mesh) @ X_WI[:3, :3].T + X_WI[:3, 3])
    return np.concatenate([np.empty((0, 3, 3)), *screens])
