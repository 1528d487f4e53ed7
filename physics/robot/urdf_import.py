"""Import of a URDF file as the settings of a robot, with lists of what was read and what was assumed."""

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from physics.robot.urdf_suspicions import Ends, angle_doubt, check_size, suspicions
from physics.robot.urdf_tree import TURNING, UrdfJoint, UrdfLink, UrdfTree
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

NOMINAL_TRACK_M, NOMINAL_BASE_M, NOMINAL_LIMIT_V = 0.14, 0.05, 6.0
"""Track, height of the base and voltage of the nominal robot; what a URDF does not have is scaled from them."""
_LEVEL = 0.1
"""Largest vertical part of the axis of a wheel."""
_ON_FLOOR_M = 0.006
"""Height of the lowest point of a caster above the floor, as in files with a little play."""
_MIN_TRACK_M, _MAX_RISE = 1e-3, 0.05
"""Smallest distance of the wheels, and the largest difference of their heights as a share of it."""
_SIDE_BY_SIDE = "two wheels side by side, on one level axle"
_WHEEL_M = (0.001, 1.0)
"""Radius or diameter of a wheel that a plug-in may state."""
_MAX_LISTED = 20
"""Number of joints in a message."""
_CASTERS = ("caster", "ball")
_CAMERAS = ("camera",)
_SENSORS = (*_CAMERAS, "lidar", "laser", "scan", "imu", "gyro", "sonar", "range", "depth", "gps", "bumper")
"""Parts of the names of links that are sensors."""


@dataclass
class ImportedRobot:
    """Settings of a robot file, and how each came about."""

    settings: dict[str, Any]
    read: list[str] = field(default_factory=list)
    """Sentences about what the file says."""
    assumed: list[str] = field(default_factory=list)
    """Sentences about what it does not say."""
    ignored: list[str] = field(default_factory=list)
    """Sentences about links, and other parts of the file, that the robot does not have."""
    suspicious: list[str] = field(default_factory=list)
    """Sentences about what is probably wrong."""

    def lists(self) -> Iterator[tuple[str, list[str]]]:
        """Yield each list of sentences that is not empty, with its heading."""
        for heading, sentences in (
            ("read", self.read),
            ("assumed", self.assumed),
            ("not used", self.ignored),
            ("check", self.suspicious),
        ):
            if sentences:
                yield heading, sentences


@dataclass(frozen=True)
class _Wheel:
    joint: UrdfJoint
    center: Array
    radius_m: float
    width_m: float | None


def robot_from_urdf(tree: UrdfTree, name: str, where: str, wheels: tuple[str, str] | None = None) -> ImportedRobot:
    """Return the settings of a differential robot.

    Args:
        tree: The bodies.
        name: Name of the robot.
        where: The file, for messages.
        wheels: Names of the joints of the left and the right wheel; by default they are looked for.

    Raises:
        InputError: There is no pair of wheels, or there are several.
    """
    left, right = _pair(tree, where, wheels)
    check_size(float(np.linalg.norm(left.center - right.center)), where)
    robot = _Importer(tree, name, left, right).robot()
    ends = Ends((left.joint.name, right.joint.name), (float(left.center[1]), float(right.center[1])))
    robot.suspicious += suspicions(tree, ends, left.joint.speed_rad_s, left.radius_m)
    return robot


class _Importer:
    def __init__(self, tree: UrdfTree, name: str, left: _Wheel, right: _Wheel) -> None:
        self._tree, self._left, self._right = tree, left, right
        self._wheel_links = {left.joint.child, right.joint.child}
        across = left.center - right.center
        self._track_m = float(np.linalg.norm(across))
        self._radius_m = 0.5 * (left.radius_m + right.radius_m)
        y = across / self._track_m
        z = np.array([0.0, 0.0, 1.0])
        x = np.cross(y, z)
        self._to_R = np.stack([x / np.linalg.norm(x), y, z])
        self._origin = 0.5 * (left.center + right.center) - self._radius_m * z
        self._imported = ImportedRobot({"extends": "nominal", "scale": _rounded(self._track_m / NOMINAL_TRACK_M)})
        self._imported.settings["name"] = name
        self._camera_link: UrdfLink | None = None

    def robot(self) -> ImportedRobot:
        imported = self._imported
        imported.settings["description"] = f"Imported from the URDF of {self._tree.name or 'a robot'}"
        self._drive()
        self._chassis()
        self._camera()
        self._motor()
        self._ignored()
        imported.assumed.append(
            f"gains of wheel loop and controller, line sensor and range sensors: those of the nominal robot, scaled by "
            f"{imported.settings['scale']:g}, the ratio of the tracks"
        )
        return imported

    def _in_R(self, points: Array) -> Array:
        return (points - self._origin) @ self._to_R.T

    def _drive(self) -> None:
        imported, track_m = self._imported, self._track_m
        drive: dict[str, Any] = {"track_m": _rounded(track_m), "wheel_diameter_m": _rounded(2.0 * self._radius_m)}
        joints = f"{self._left.joint.name} and {self._right.joint.name}"
        imported.read.append(f"wheels {joints}: track {track_m:.4g} m, diameter {2.0 * self._radius_m:.4g} m")
        widths = [wheel.width_m for wheel in (self._left, self._right) if wheel.width_m]
        if widths:
            drive["wheel_width_m"] = _rounded(max(widths))
        else:
            drive["wheel_width_m"] = _rounded(0.6 * self._radius_m)
            imported.assumed.append(f"width of the wheels {drive['wheel_width_m']:g} m")
        masses = [self._tree.links[name].mass_kg for name in self._wheel_links]
        if min(masses) > 0.0:
            drive["wheel_mass_kg"] = _rounded(sum(masses) / 2.0)
            imported.read.append(f"mass of a wheel {drive['wheel_mass_kg']:g} kg")
        self._width_m = drive["wheel_width_m"]
        self._caster(drive)
        imported.settings["drive"] = drive

    def _caster(self, drive: dict[str, Any]) -> None:
        """Take the body farthest from the axle that touches the floor there; a robot has one caster here."""
        casters: list[tuple[float, str, float]] = []
        for link in self._others():
            named = any(word in link.name.lower() for word in _CASTERS)
            for shape in link.shapes:
                points = self._in_R(shape.corners())
                if len(points) and points[:, 2].min() < _ON_FLOOR_M and (named or shape.kind == "sphere"):
                    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
                    radius_m = float(shape.size_m[0]) if shape.kind != "box" else float(np.ptp(points[:, 2])) / 2.0
                    casters.append((float(middle[0]), link.name, radius_m))
        if not casters:
            drive["caster_x_m"] = _rounded(-0.5 * self._track_m)
            self._imported.assumed.append(f"caster {-drive['caster_x_m']:g} m behind the axle: no link is one")
            return
        x_m, link_name, radius_m = max(casters, key=lambda caster: abs(caster[0]))
        drive["caster_x_m"], drive["caster_radius_m"] = _rounded(x_m), _rounded(min(max(radius_m, 0.002), 0.1))
        self._imported.read.append(f"caster {link_name}: {x_m:.4g} m ahead of the axle, radius {radius_m:.4g} m")
        if len(casters) > 1:
            self._imported.assumed.append(f"one caster in place of {len(casters)}: {link_name}")

    def _others(self) -> list[UrdfLink]:
        return [link for link in self._tree.links.values() if link.name not in self._wheel_links]

    def _chassis(self) -> None:
        imported, drive = self._imported, self._imported.settings["drive"]
        chassis: dict[str, Any] = {}
        mass_kg = sum(link.mass_kg for link in self._others())
        if mass_kg > 0.0:
            weighed = sum(link.mass_kg * self._in_R(link.center_of_mass[None])[0] for link in self._others())
            center = np.asarray(weighed) / mass_kg
            chassis["mass_kg"] = _rounded(mass_kg)
            imported.read.append(f"mass without wheels {mass_kg:.4g} kg, its centre at x {center[0]:.4g} m")
            low, high = sorted((0.0, 0.95 * drive["caster_x_m"]))
            x_m = min(max(float(center[0]), low), high)
            if x_m != center[0]:
                imported.assumed.append(
                    f"centre of mass at x {x_m:.4g} m, between axle and caster, or it would tip over"
                )
            chassis["center_of_mass_x_m"], chassis["center_of_mass_z_m"] = _rounded(x_m), _rounded(float(center[2]))
        else:
            imported.assumed.append("mass and its centre: those of the nominal robot, scaled")
        points = [self._in_R(shape.corners()) for link in self._others() for shape in link.shapes]
        points = [some for some in points if len(some) and some[:, 2].min() > _ON_FLOOR_M / 2.0]
        meshes = sum(shape.kind == "mesh" for link in self._others() for shape in link.shapes)
        if meshes:
            imported.assumed.append(f"{meshes} bodies that are meshes have no size here; check chassis in the file")
        width_m = self._track_m + self._width_m
        if points:
            body = np.concatenate(points)
            length_m = 2.0 * float(np.abs(body[:, 0]).max())
            width_m = max(width_m, 2.0 * float(np.abs(body[:, 1]).max()))
            clearance_m, top_m = float(body[:, 2].min()), float(body[:, 2].max())
            chassis["clearance_m"] = _rounded(min(max(clearance_m, 0.002), 0.9 * 2.0 * self._radius_m))
            chassis["base_height_m"] = _rounded(min(max(top_m, chassis["clearance_m"] + 0.01), 0.5))
            imported.read.append(
                f"body: {length_m:.4g} m long, from {clearance_m:.4g} to {top_m:.4g} m above the floor"
            )
            imported.assumed.append("the body is a box centred on the axle that encloses all shapes")
        else:
            length_m = 2.0 * max(abs(drive["caster_x_m"]) + 0.01, 1.1 * self._radius_m)
            imported.assumed.append(f"length of the body {length_m:.4g} m, up to the caster")
        length_m = max(length_m, 2.0 * self._radius_m, 2.0 * abs(drive["caster_x_m"]))
        chassis["length_m"], chassis["width_m"] = _up(length_m), _up(width_m)
        imported.settings["chassis"] = chassis

    def _camera(self) -> None:
        named = [link for link in self._others() if any(word in link.name.lower() for word in _CAMERAS)]
        if not named:
            self._imported.assumed.append("camera: that of the nominal robot, scaled")
            return
        link = self._camera_link = min(named, key=lambda one: ("optical" in one.name.lower(), len(one.name)))
        x_m, y_m, z_m = self._in_R(link.X_root[:3, 3][None])[0].tolist()
        ahead = self._to_R @ link.X_root[:3, :3] @ np.array([1.0, 0.0, 0.0])
        pitch_deg = math.degrees(math.asin(max(-1.0, min(1.0, -float(ahead[2])))))
        chassis = self._imported.settings["chassis"]
        base_m = chassis.get("base_height_m", NOMINAL_BASE_M * self._imported.settings["scale"])
        if z_m < base_m:
            base_m = chassis["base_height_m"] = _rounded(max(z_m, chassis.get("clearance_m", 0.0) + 0.01))
            self._imported.assumed.append(f"the body ends at the height of the camera, {base_m:.4g} m")
        camera = {"x_m": _rounded(x_m), "y_m": _rounded(y_m), "height_above_base_m": _rounded(max(0.0, z_m - base_m))}
        camera |= {"pitch_down_deg": _rounded(min(max(pitch_deg, -10.0), 90.0))}
        camera |= {"yaw_left_deg": _rounded(math.degrees(math.atan2(ahead[1], ahead[0])))}
        self._imported.settings["camera"] = camera
        self._imported.read.append(f"camera {link.name}: x {x_m:.4g} m, height {z_m:.4g} m, {pitch_deg:.3g} deg down")
        self._imported.assumed.append("lens of the camera: that of the nominal robot")

    def _motor(self) -> None:
        torque_N_m, speed_rad_s = self._left.joint.effort_N_m, self._left.joint.speed_rad_s
        if torque_N_m is None or speed_rad_s is None:
            self._imported.assumed.append("motors: those of the nominal robot, scaled; the joints have no limits")
            return
        # Without load K w = U, and at rest K U / R is the torque (Eq. 18).
        constant = NOMINAL_LIMIT_V / speed_rad_s
        self._imported.settings["motor"] = {
            "winding_resistance_ohm": _rounded(constant * NOMINAL_LIMIT_V / torque_N_m),
            "torque_constant_N_m_A": _rounded(constant),
            "viscous_friction_N_m_s_rad": 0.0,
            "coulomb_friction_N_m": _rounded(0.03 * torque_N_m),
        }
        self._imported.read.append(f"motors: {torque_N_m:g} N m at rest, {speed_rad_s:g} rad/s without load")
        self._imported.assumed.append(f"{NOMINAL_LIMIT_V:g} V motors with a dry friction of 3 % of their torque")

    def _ignored(self) -> None:
        """List meshes, inertias and sensors, and links at the end of a branch that have neither mass nor shape."""
        if meshes := self._tree.meshes:
            names = ", ".join(meshes[:_MAX_LISTED])
            self._imported.ignored.append(f"meshes, of which no size is read: {names}; body.mesh takes a file")
        if self._tree.inertias:
            self._imported.ignored.append(
                f"moments of inertia of {plural(self._tree.inertias, 'link')}: they follow from masses and sizes"
            )
        parents = {joint.parent for joint in self._tree.joints}
        for link in self._others():
            is_empty = link.mass_kg == 0.0 and not link.shapes
            is_sensor = any(word in link.name.lower() for word in _SENSORS)
            if link is self._camera_link or link.name in parents or not (is_empty or is_sensor):
                continue
            x_m, y_m, z_m = self._in_R(link.X_root[:3, 3][None])[0].tolist()
            place = f"x {_place(x_m)} m, y {_place(y_m)} m, z {_place(z_m)} m"
            what = "has neither mass nor shape" if is_empty else "gives the body mass and shape, and is no sensor"
            self._imported.ignored.append(f"link {link.name} at {place}: {what}; sensors are keys of robot.sensors")


def _pair(tree: UrdfTree, where: str, names: tuple[str, str] | None) -> tuple[_Wheel, _Wheel]:
    turning = {joint.name: joint for joint in tree.joints if joint.kind in TURNING and abs(joint.axis[2]) < _LEVEL}
    stated = (tree.settings.get("left_joint", ""), tree.settings.get("right_joint", ""))
    chosen = names or (stated if all(name in turning for name in stated) else None)
    if chosen is None:
        chosen = _likely_pair(tree, turning, where)
    for name in chosen:
        if name not in turning:
            allowed = ", ".join(turning) or "a joint that turns about a level axis"
            raise InputError("--wheels", where=where, got=name, allowed=allowed)
    left, right = (_wheel(tree, turning[name], where) for name in chosen)
    *beside_m, above_m = (left.center - right.center).tolist()
    if math.hypot(*beside_m) < _MIN_TRACK_M or abs(above_m) > _MAX_RISE * math.hypot(*beside_m):
        raise InputError("wheels", where=where, got=", ".join(chosen), allowed=_SIDE_BY_SIDE)
    return left, right


def _likely_pair(tree: UrdfTree, turning: dict[str, UrdfJoint], where: str) -> tuple[str, str]:
    """Return the joints whose names differ in left and right alone."""
    pairs = []
    for name in turning:
        for one, other in (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"), ("_l_", "_r_"), ("l_", "r_")):
            if one in name and name.replace(one, other, 1) in turning and "caster" not in name.lower():
                pairs.append((name, name.replace(one, other, 1)))
                break
    if len(pairs) != 1:
        cure = "name the joints with --wheels LEFT,RIGHT"
        if turning:
            cure += f"; joints that turn about a level axis are {', '.join([*turning][:_MAX_LISTED])}"
        if len(pairs) > 1:
            cure += "; a robot with four driven wheels cannot be simulated"
        got = f"{len(pairs)} pairs of wheels" + (f": {', '.join(left for left, _ in pairs)}" if pairs else "")
        if doubt := angle_doubt(tree):
            cure = f"{doubt}; {cure}"
        raise InputError("joints", where=where, got=got, allowed="one left and one right wheel", cure=cure)
    return pairs[0]


def _wheel(tree: UrdfTree, joint: UrdfJoint, where: str) -> _Wheel:
    link = tree.links[joint.child]
    round_shapes = [shape for shape in link.shapes if shape.kind in {"cylinder", "sphere"}]
    if round_shapes:
        shape = max(round_shapes, key=lambda one: one.size_m[0])
        width_m = shape.size_m[1] if shape.kind == "cylinder" else None
        return _Wheel(joint, shape.X_root[:3, 3], shape.size_m[0], width_m)
    for setting, factor in (("wheel_radius", 1.0), ("wheel_diameter", 0.5)):
        if setting in tree.settings:
            return _Wheel(joint, link.X_root[:3, 3], factor * _length_m(tree, setting, where), None)
    cure = "add a cylinder as its collision, or a plug-in with wheel_radius"
    raise InputError(f"wheel {joint.child}: no cylinder and no sphere", where=where, cure=cure)


def _length_m(tree: UrdfTree, setting: str, where: str) -> float:
    low, high = _WHEEL_M
    text = tree.settings[setting]
    with suppress(ValueError):
        if low <= float(text) <= high:
            return float(text)
    raise InputError(setting, where=where, got=text, allowed=f"a length in metres, from {low:g} to {high:g}")


def _rounded(value: float) -> float:
    return float(f"{value:.6g}") + 0.0


def _place(metres: float) -> str:
    return f"{round(metres, 4) + 0.0:g}"


def _up(value: float) -> float:
    """Round up, so that a box encloses its content."""
    return math.ceil(value * 1e4 - 1e-6) / 1e4
