"""The robot as SDF 1.9 for Gazebo: links, wheel joints, sensors and a drive that takes twists."""

from xml.etree import ElementTree as ET

from blender_scenes.scene.robot_body import CAMERA_BODY
from physics.robot.links import BASE, BoxShape, RobotLink, SphereShape
from pipeline.models.geometry import CylinderShape, Placement, Shape, Visual
from pipeline.models.robot import RobotParts
from pipeline.models.sdf_elements import add_pose, child
from pipeline.models.sdf_sensors import OWN_BODY, add_sensors
from sensors.camera.colour import RGB

FLOOR_BIT, WALLS_BIT = 1, 2
"""Collision bits as in the engine: wheels and caster collide with the floor only, the chassis with walls and
obstacles only."""
_WITHOUT_LIMIT = 1e16
"""Angle [rad] that stands for a joint without limit; PyBullet needs a limit."""


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
            add_sensors(element, parts)
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
            child(shown, "visibility_flags", OWN_BODY)
    return element


def _joint(model: ET.Element, link: RobotLink) -> None:
    joint = child(model, "joint", name=f"{link.name}_joint", type="fixed" if link.motor is None else "revolute")
    child(joint, "parent", BASE)
    child(joint, "child", link.name)
    if link.motor is not None:
        limit = {"lower": -_WITHOUT_LIMIT, "upper": _WITHOUT_LIMIT}
        dynamics = {"damping": link.motor.damping_N_m_s_rad, "friction": link.motor.coulomb_N_m}
        child(joint, "axis", {"xyz": (0, 1, 0), "limit": limit, "dynamics": dynamics})


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
