"""The robot as SDF 1.9 for Gazebo: links, wheel joints, camera, range sensors and a drive that takes twists."""

from collections.abc import Mapping
from math import ceil, radians, sqrt
from xml.etree import ElementTree as ET

from blender_scenes.scene.robot_body import CAMERA_BODY
from configs.schema.robot import TofSensor
from physics.robot.links import BASE, BoxShape, RobotLink, SphereShape
from pipeline.models.geometry import CylinderShape, Placement, Shape, Visual
from pipeline.models.robot import CAMERA, CAMERA_OPTICAL, NamedFrame, RobotParts
from sensors.camera.colour import RGB
from sensors.tof import NOISE_AT_NEAR_MM

VERSION = "1.9"
FLOOR_BIT, WALLS_BIT = 1, 2
"""Collision bits as in the engine: wheels and caster collide with the floor only, the chassis with walls and
obstacles only."""
_WITHOUT_LIMIT = 1e16
"""Angle [rad] that stands for a joint without limit; PyBullet needs a limit."""
_NEAR_M, _FAR_M = "0.01", "100"
_OWN_BODY, _ALL_BUT_OWN_BODY = 2, 2**32 - 1 - 2
"""Visibility flags: the camera sees as much of its own robot as in the images."""


def child(parent: ET.Element, tag: str, value: object = None, **attributes: str) -> ET.Element:
    """Add an element to `parent` and return it.

    Args:
        parent: Element to which it is added.
        tag: Its tag.
        value: Its text, or a mapping from the tags of its own children to their values. Several numbers are a tuple. A
            float has all digits that it needs to be read back unchanged.
        attributes: Its attributes.
    """
    element = ET.SubElement(parent, tag, attributes)
    if isinstance(value, Mapping):
        for inner_tag, inner in value.items():
            child(element, inner_tag, inner)
    elif isinstance(value, tuple):
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
    match shape:
        case BoxShape(size):
            geometry = {"box": {"size": size}}
        case SphereShape(radius):
            geometry = {"sphere": {"radius": radius}}
        case CylinderShape(radius, width):
            geometry = {"cylinder": {"radius": radius, "length": width}}
    child(parent, "geometry", geometry)


def add_material(parent: ET.Element, srgb: RGB) -> None:
    child(parent, "material", {"ambient": (*srgb, 1), "diffuse": (*srgb, 1)})


def add_surface(collision: ET.Element, bit: int, friction: float | None) -> None:
    surface = child(collision, "surface", {"contact": {"collide_bitmask": bit}})
    if friction is not None:
        child(surface, "friction", {"ode": {"mu": friction, "mu2": friction}})


def robot_model(parts: RobotParts, placement: Placement = Placement()) -> ET.Element:  # noqa: B008 - frozen
    """Return a model with the name of the robot and the frame of its base."""
    model = ET.Element("model", name=parts.config.name, canonical_link=BASE)
    add_pose(model, placement)
    for link in parts.links:
        element = _link(model, link, parts.visuals[link.name], sees_robot=parts.config.camera.sees_robot)
        if link.name == BASE:
            _camera(element, parts)
            for frame in parts.frames:
                if frame.name.startswith("tof_"):
                    _range_sensor(element, frame, parts.config.tof)
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
    ixx, iyy, izz = link.inertia_kg_m2
    child(inertial, "inertia", {"ixx": ixx, "iyy": iyy, "izz": izz, "ixy": 0, "ixz": 0, "iyz": 0})
    collision = child(element, "collision", name=f"{link.name}_collision")
    add_pose(collision, Placement(link.shape_center))
    add_geometry(collision, link.shape)
    add_surface(collision, WALLS_BIT if link.name == BASE else FLOOR_BIT, link.friction)
    for visual in visuals:
        shown = child(element, "visual", name=visual.name)
        add_pose(shown, visual.placement)
        add_geometry(shown, visual.shape)
        add_material(shown, visual.srgb)
        if not sees_robot or visual.name == CAMERA_BODY:
            child(shown, "visibility_flags", _OWN_BODY)
    return element


def _joint(model: ET.Element, link: RobotLink) -> None:
    joint = child(model, "joint", name=f"{link.name}_joint", type="fixed" if link.motor is None else "revolute")
    child(joint, "parent", BASE)
    child(joint, "child", link.name)
    if link.motor is not None:
        limit = {"lower": -_WITHOUT_LIMIT, "upper": _WITHOUT_LIMIT}
        dynamics = {"damping": link.motor.damping_N_m_s_rad, "friction": link.motor.coulomb_N_m}
        child(joint, "axis", {"xyz": (0, 1, 0), "limit": limit, "dynamics": dynamics})


def _camera(base: ET.Element, parts: RobotParts) -> None:
    """Add the camera of side/intrinsics.json. Pixel coordinates are those of pixel centres there, and of pixel edges
    here.
    """
    intrinsics = parts.camera
    sensor = child(base, "sensor", name=CAMERA, type="camera")
    add_pose(sensor, parts.frame(CAMERA).placement)
    child(sensor, "update_rate", parts.camera_hz)
    child(sensor, "topic", CAMERA)
    camera = child(sensor, "camera")
    child(camera, "horizontal_fov", parts.horizontal_field_of_view_rad)
    child(camera, "image", {"width": intrinsics.width_px, "height": intrinsics.height_px, "format": "R8G8B8"})
    child(camera, "clip", {"near": _NEAR_M, "far": _FAR_M})
    if any(intrinsics.distortion):
        child(camera, "distortion", dict(zip(("k1", "k2", "p1", "p2", "k3"), intrinsics.distortion, strict=True)))
    center = {"cx": intrinsics.cx_px + 0.5, "cy": intrinsics.cy_px + 0.5}
    child(camera, "lens", {"intrinsics": {"fx": intrinsics.fx_px, "fy": intrinsics.fy_px, **center, "s": 0}})
    child(camera, "optical_frame_id", CAMERA_OPTICAL)
    child(camera, "visibility_mask", _ALL_BUT_OWN_BODY)


def _range_sensor(base: ET.Element, frame: NamedFrame, tof: TofSensor) -> None:
    """Add a square bundle of at least as many rays around the cone. Each ray has a reading, where the device has
    one.
    """
    half_rad = 0.5 * radians(tof.field_of_view_deg)
    rays = {"samples": ceil(sqrt(tof.rays)), "resolution": 1, "min_angle": -half_rad, "max_angle": half_rad}
    distances = {"min": tof.min_range_m, "max": tof.max_range_m, "resolution": tof.quantisation_m}
    noise = {"type": "gaussian", "mean": 0, "stddev": round(1e-3 * NOISE_AT_NEAR_MM * tof.noise_scale, 9)}
    sensor = child(base, "sensor", name=frame.name, type="gpu_lidar")
    add_pose(sensor, frame.placement)
    child(sensor, "update_rate", 1 / tof.period_s)
    child(sensor, "topic", frame.name)
    child(sensor, "lidar", {"scan": {"horizontal": rays, "vertical": rays}, "range": distances, "noise": noise})


def _drive(model: ET.Element, parts: RobotParts) -> None:
    """Add the drive with the nominal numbers, not with those of a worn wheel."""
    drive = parts.config.drive
    settings = {
        "left_joint": "left_wheel_joint",
        "right_joint": "right_wheel_joint",
        "wheel_separation": drive.track_m,
        "wheel_radius": 0.5 * drive.wheel_diameter_m,
        "odom_publish_frequency": parts.control_hz,
        "topic": "cmd_vel",
        "odom_topic": "odom",
        "frame_id": "odom",
        "child_frame_id": BASE,
    }
    child(model, "plugin", settings, filename="gz-sim-diff-drive-system", name="gz::sim::systems::DiffDrive")
    states = "gz-sim-joint-state-publisher-system"
    child(model, "plugin", filename=states, name="gz::sim::systems::JointStatePublisher")
