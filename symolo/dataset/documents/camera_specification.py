"""Further cameras: the specification of a run with one of them in the place of the camera of data.csv.

`robot.camera`, `render` and `look.camera` describe the camera of data.csv. A further camera is a sensor of
`robot.sensors` of the kind `camera`. Everything that renders, describes or checks the images of a camera takes a
specification; for a further camera it takes the one that this module makes. The cameras change places, so that both
specifications have the same cameras on the robot.
"""

from collections.abc import Mapping
from typing import Any

KIND = "camera"
"""Kind of a sensor of `robot.sensors` that takes images."""
_LENS = (
    "focal_length_mm",
    "sensor_width_mm",
    "principal_point_right_mm",
    "principal_point_down_mm",
    "distortion",
    "fisheye",
    "read_out_s",
    "sees_robot",
)
"""Settings that `robot.camera` has too."""
_ANGLES = {"pitch_up_deg": ("pitch_down_deg", -1.0), "yaw_deg": ("yaw_left_deg", 1.0), "roll_deg": ("roll_deg", 1.0)}
"""Angles of a sensor: the name in `robot.camera`, and the factor to it."""
_RENDER = ("width_px", "height_px", "quality", "annotations")


def further_cameras(content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of the further cameras of a specification, which is plain data as in side/spec.json."""
    sensors = content["robot"].get("sensors", {})
    return tuple(sorted(name for name, settings in sensors.items() if settings.get("kind") == KIND))


def specification_of(content: Mapping[str, Any], camera: str) -> dict[str, Any]:
    """Return the specification in which a further camera is that of data.csv, and the other way round."""
    robot, look, render = content["robot"], content["look"], content["render"]
    settings, nominal = robot["sensors"][camera], robot["camera"]
    base_m = robot["chassis"]["base_height_m"]
    mounted = {"x_m": settings["x_m"], "y_m": settings["y_m"], "height_above_base_m": settings["z_m"] - base_m}
    mounted |= {name: factor * settings[angle] + 0.0 for angle, (name, factor) in _ANGLES.items()}
    mounted |= {name: settings[name] for name in _LENS if name in settings}
    listed = {
        "kind": KIND,
        "period_s": settings["period_s"],
        "delay_s": settings["delay_s"],
        "x_m": nominal["x_m"],
        "y_m": nominal["y_m"],
        "z_m": nominal["height_above_base_m"] + base_m,
    }
    listed |= {angle: factor * nominal[name] + 0.0 for angle, (name, factor) in _ANGLES.items()}
    listed |= {name: nominal[name] for name in _LENS if name in nominal}
    camera_render = {name: settings[name] for name in _RENDER if settings.get(name) is not None}
    if settings.get("fisheye") is not None:
        camera_render["method"] = "full"  # hybrid rendering makes pinhole images
    elif "quality" in camera_render:
        camera_render["method"] = "auto"
    response = dict(look["camera"])
    if settings.get("exposure_time_s") is not None:
        response["exposure_time_s"] = settings["exposure_time_s"]
    return {
        **content,
        "robot": {**robot, "camera": mounted, "sensors": {**robot["sensors"], camera: listed}},
        "look": {**look, "camera": response},
        "render": {**render, **camera_render},
    }
