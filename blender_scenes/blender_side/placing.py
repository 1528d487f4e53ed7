"""Poses of camera, robot and moving obstacles in a view, at rest or moving during the exposure."""

import bpy
import numpy as np
from mathutils import Matrix

from blender_scenes.blender_side.build import CAMERA, ROBOT, moving_name
from sensors.camera.shutter import MOMENTS, Window
from sensors.camera.views import FrameView, Moment
from symolo.core.geometry.poses import pose_X_WR

_FRAME = 1
"""Frame of Blender's time line; the exposure window is one frame long and centred on it."""


def open_shutter(exposure: Window) -> None:
    """Set Cycles' shutter for all views with an exposure; `place` switches it on."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.motion_blur_position, render.motion_blur_shutter = "CENTER", 1.0
    curve = render.motion_blur_shutter_curve.curves[0]
    for point in curve.points:
        point.location[1] = 1.0  # fully open from the start
    cycles.rolling_shutter_type = "NONE" if exposure.row_share == 1.0 else "TOP"
    cycles.rolling_shutter_duration = exposure.row_share
    for item in bpy.data.objects:
        item.cycles.motion_steps = 1 + int(np.log2(MOMENTS - 1))
    scene.frame_set(_FRAME)


def place(view: FrameView) -> None:
    """Put everything in its place, and switch motion blur on if the view has an exposure."""
    bpy.context.scene.render.use_motion_blur = bool(view.exposure)
    moments = view.exposure or (Moment(view.robot_pose, view.X_WC, view.moving),)
    # Blender's camera looks along its -z with y up: the optical frame after half a turn about x.
    poses = {CAMERA: [np.array(moment.X_WC) @ np.diag([1.0, -1.0, -1.0, 1.0]) for moment in moments]}
    poses[ROBOT] = [pose_X_WR(*moment.robot_pose) for moment in moments]
    for number in range(len(view.moving)):
        poses[moving_name(number)] = [pose_X_WR(*moment.moving[number]) for moment in moments]
    for name, motion in poses.items():
        item = bpy.data.objects[name]
        _clear(item)
        if view.exposure:
            _animate(item, motion)
        else:
            item.matrix_world = Matrix(motion[0].tolist())


def _clear(item: bpy.types.Object) -> None:
    """Delete the keyframes of an object, which Blender would keep even when nothing uses them any more."""
    action = item.animation_data.action if item.animation_data else None
    item.animation_data_clear()
    if action is not None:
        bpy.data.actions.remove(action)


def _animate(item: bpy.types.Object, motion: list[np.ndarray]) -> None:
    """Set keyframes at equal distances over the window, with linear interpolation."""
    item.rotation_mode = "QUATERNION"
    for number, pose in enumerate(motion):
        before = item.rotation_quaternion.copy()
        item.matrix_world = Matrix(pose.tolist())
        if number:
            item.rotation_quaternion.make_compatible(before)
        for channel in ("location", "rotation_quaternion"):
            item.keyframe_insert(channel, frame=_FRAME - 0.5 + number / (MOMENTS - 1))
    for curve in item.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
