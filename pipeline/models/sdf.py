"""The robot as SDF 1.9 for Gazebo: links, wheel joints, camera, range sensors and a drive that takes twists."""

from math import ceil, pi, radians, sqrt
from xml.etree import ElementTree as ET

from blender_scenes.scene.robot_body import CAMERA_BODY
from physics.robot.links import BASE, BoxShape, RobotLink, SphereShape
from pipeline.models.geometry import CylinderShape, Placement, Shape, Visual
from pipeline.models.robot import CAMERA, CAMERA_OPTICAL, RobotParts
from sensors.tof import NOISE_AT_NEAR_MM

VERSION = "1.9"
FLOOR_BIT, WALLS_BIT = 1, 2
"""Collision bits as in the engine: wheels and caster collide with the floor only, the chassis with walls and
obstacles only."""
_LYING = (0.5 * pi, 0.0, 0.0)
"""SDF's cylinders stand along z, wheels lie along y."""
_WITHOUT_LIMIT = 1e16
"""Angle [rad] that stands for a joint without limit; PyBullet needs a limit."""
_CLIP_M = ("0.01", "100")
_OWN_BODY, _ALL_BUT_IT = 2, 2**32 - 1 - 2
"""Visibility flags: the camera sees as much of its own robot as in the images."""


def child(parent: ET.Element, tag: str, value: object = None, **attributes: str) -> ET.Element:
    """Return a new element with a text; a float has all digits that it needs to be read back unchanged."""
    element = ET.SubElement(parent, tag, attributes)
    if isinstance(value, tuple):
        element.text = " ".join(map(str, value))
    elif value is not None:
        element.text = str(value)
    return element


def document(*contents: ET.Element) -> bytes:
    root = ET.Element("sdf", version=VERSION)
    root.extend(contents)
    ET.indent(root)
    return b'<?xml version="1.0"?>\n' + ET.tostring(root, encoding="utf-8", xml_declaration=False) + b"\n"


def add_pose(parent: ET.Element, placement: Placement) -> None:
    if placement != Placement():
        child(parent, "pose", (*placement.xyz, *placement.rpy))


def add_geometry(parent: ET.Element, shape: Shape) -> None:
    geometry = child(parent, "geometry")
    match shape:
        case BoxShape(size):
            child(child(geometry, "box"), "size", size)
        case SphereShape(radius):
            child(child(geometry, "sphere"), "radius", radius)
        case CylinderShape(radius, width):
            cylinder = child(geometry, "cylinder")
            child(cylinder, "radius", radius)
            child(cylinder, "length", width)


def add_material(parent: ET.Element, srgb: tuple[float, float, float]) -> None:
    material = child(parent, "material")
    for what in ("ambient", "diffuse"):
        child(material, what, (*srgb, 1))


def add_surface(collision: ET.Element, bit: int, friction: float | None) -> None:
    surface = child(collision, "surface")
    child(child(surface, "contact"), "collide_bitmask", bit)
    if friction is not None:
        ode = child(child(surface, "friction"), "ode")
        child(ode, "mu", friction)
        child(ode, "mu2", friction)


def robot_model(parts: RobotParts, placement: Placement = Placement()) -> ET.Element:  # noqa: B008 - frozen
    """Return a model with the name of the robot and the frame of its base."""
    model = ET.Element("model", name=parts.config.name, canonical_link=BASE)
    add_pose(model, placement)
    for link in parts.links:
        element = _link(model, link, parts.visuals[link.name], sees_robot=parts.config.camera.sees_robot)
        if link.name == BASE:
            _sensors(element, parts)
        else:
            _joint(model, link)
    for frame in parts.frames:
        add_pose(child(model, "frame", name=frame.name, attached_to=BASE), frame.placement)
    _drive(model, parts)
    return model


def _link(model: ET.Element, link: RobotLink, visuals: tuple[Visual, ...], *, sees_robot: bool) -> ET.Element:
    element = child(model, "link", name=link.name)
    add_pose(element, Placement(link.origin))
    inertial = child(element, "inertial")
    add_pose(inertial, Placement(link.center_of_mass))
    child(inertial, "mass", link.mass_kg)
    inertia = child(inertial, "inertia")
    for axis, moment in zip(("ixx", "iyy", "izz"), link.inertia_kg_m2, strict=True):
        child(inertia, axis, moment)
    for axes in ("ixy", "ixz", "iyz"):
        child(inertia, axes, 0)
    collision = child(element, "collision", name=f"{link.name}_collision")
    add_pose(collision, Placement(link.shape_center))
    add_geometry(collision, link.shape)
    add_surface(collision, WALLS_BIT if link.name == BASE else FLOOR_BIT, link.friction)
    for visual in visuals:
        seen = child(element, "visual", name=visual.name)
        add_pose(seen, Placement(visual.center, _LYING if isinstance(visual.shape, CylinderShape) else (0.0, 0.0, 0.0)))
        add_geometry(seen, visual.shape)
        add_material(seen, visual.srgb)
        if not sees_robot or visual.name == CAMERA_BODY:
            child(seen, "visibility_flags", _OWN_BODY)
    return element


def _joint(model: ET.Element, link: RobotLink) -> None:
    joint = child(model, "joint", name=f"{link.name}_joint", type="fixed" if link.motor is None else "revolute")
    child(joint, "parent", BASE)
    child(joint, "child", link.name)
    if link.motor is not None:
        axis = child(joint, "axis")
        child(axis, "xyz", (0, 1, 0))
        limit = child(axis, "limit")
        child(limit, "lower", -_WITHOUT_LIMIT)
        child(limit, "upper", _WITHOUT_LIMIT)
        dynamics = child(axis, "dynamics")
        child(dynamics, "damping", link.motor.damping_N_m_s_rad)
        child(dynamics, "friction", link.motor.coulomb_N_m)


def _sensors(base: ET.Element, parts: RobotParts) -> None:
    _camera(base, parts)
    for frame in parts.frames:
        if frame.name.startswith("tof_"):
            sensor = child(base, "sensor", name=frame.name, type="gpu_lidar")
            add_pose(sensor, frame.placement)
            _range(sensor, parts)


def _camera(base: ET.Element, parts: RobotParts) -> None:
    """Add the camera of side/intrinsics.json. Pixel coordinates are those of pixel centres there, and of pixel edges
    here.
    """
    seen = parts.camera
    sensor = child(base, "sensor", name=CAMERA, type="camera")
    add_pose(sensor, parts.frame(CAMERA).placement)
    child(sensor, "update_rate", parts.camera_hz)
    child(sensor, "topic", CAMERA)
    camera = child(sensor, "camera")
    child(camera, "horizontal_fov", parts.horizontal_field_of_view_rad)
    image = child(camera, "image")
    child(image, "width", seen.width_px)
    child(image, "height", seen.height_px)
    child(image, "format", "R8G8B8")
    clip = child(camera, "clip")
    for tag, metres in zip(("near", "far"), _CLIP_M, strict=True):
        child(clip, tag, metres)
    if any(seen.distortion):
        distortion = child(camera, "distortion")
        for tag, value in zip(("k1", "k2", "p1", "p2", "k3"), seen.distortion, strict=True):
            child(distortion, tag, value)
    intrinsics = child(child(camera, "lens"), "intrinsics")
    focal = {"fx": seen.fx_px, "fy": seen.fy_px, "cx": seen.cx_px + 0.5, "cy": seen.cy_px + 0.5, "s": 0}
    for tag, value in focal.items():
        child(intrinsics, tag, value)
    child(camera, "optical_frame_id", CAMERA_OPTICAL)
    child(camera, "visibility_mask", _ALL_BUT_IT)


def _range(sensor: ET.Element, parts: RobotParts) -> None:
    """Add a square bundle of at least as many rays around the cone. Each ray has a reading, where the device has
    one.
    """
    tof = parts.config.tof
    side, half = ceil(sqrt(tof.rays)), 0.5 * radians(tof.field_of_view_deg)
    child(sensor, "update_rate", 1 / tof.period_s)
    child(sensor, "topic", sensor.get("name"))
    lidar = child(sensor, "lidar")
    scan = child(lidar, "scan")
    for way in ("horizontal", "vertical"):
        rays = child(scan, way)
        child(rays, "samples", side)
        child(rays, "resolution", 1)
        child(rays, "min_angle", -half)
        child(rays, "max_angle", half)
    distances = child(lidar, "range")
    child(distances, "min", tof.min_range_m)
    child(distances, "max", tof.max_range_m)
    child(distances, "resolution", tof.quantisation_m)
    noise = child(lidar, "noise")
    child(noise, "type", "gaussian")
    child(noise, "mean", 0)
    child(noise, "stddev", round(1e-3 * NOISE_AT_NEAR_MM * tof.noise_scale, 9))


def _drive(model: ET.Element, parts: RobotParts) -> None:
    """Add the drive with the nominal numbers, not with those of a worn wheel."""
    drive = parts.config.drive
    plugin = child(model, "plugin", filename="gz-sim-diff-drive-system", name="gz::sim::systems::DiffDrive")
    child(plugin, "left_joint", "left_wheel_joint")
    child(plugin, "right_joint", "right_wheel_joint")
    child(plugin, "wheel_separation", drive.track_m)
    child(plugin, "wheel_radius", 0.5 * drive.wheel_diameter_m)
    child(plugin, "odom_publish_frequency", parts.control_hz)
    child(plugin, "topic", "cmd_vel")
    child(plugin, "odom_topic", "odom")
    child(plugin, "frame_id", "odom")
    child(plugin, "child_frame_id", BASE)
    states = "gz-sim-joint-state-publisher-system"
    child(model, "plugin", filename=states, name="gz::sim::systems::JointStatePublisher")
