"""The robot as URDF, written from its links; the same text for the same numbers.

It lacks the reflected rotor inertia, which URDF cannot express.
"""

from xml.etree import ElementTree as ET

from configs.schema.robot import RobotConfig
from physics.robot.links import BASE, BoxShape, RobotLink, SphereShape, Vector, robot_links

_NOWHERE = (0.0, 0.0, 0.0)


def robot_urdf(robot: RobotConfig, body_file: str = "") -> str:
    """Return the robot as URDF 1.0; its body is a box, or the shape of a file beside the URDF."""
    return urdf_text(robot_element(robot, body_file))


def robot_element(robot: RobotConfig, body_file: str = "") -> ET.Element:
    """Return the robot as XML elements. Joint damping is back-EMF and viscous friction, without dry friction."""
    root = ET.Element("robot", name=robot.name)
    for link in robot_links(robot):
        _link(root, link, body_file if link.name == BASE else "")
        if link.name != BASE:
            _joint(root, link)
    return root


def urdf_text(root: ET.Element) -> str:
    """Return the text of a finished tree, and indent the tree."""
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def add_shape(parent: ET.Element, shape: BoxShape | SphereShape) -> None:
    geometry = ET.SubElement(parent, "geometry")
    match shape:
        case BoxShape(size):
            ET.SubElement(geometry, "box", size=numbers(size))
        case SphereShape(radius):
            ET.SubElement(geometry, "sphere", radius=repr(radius))


def numbers(vector: Vector) -> str:
    """Return numbers with as many digits as are needed to read the same ones again."""
    return " ".join(repr(value) for value in vector)


def add_inertial(parent: ET.Element, mass_kg: float, center: Vector, inertia_kg_m2: Vector) -> None:
    inertial = ET.SubElement(parent, "inertial")
    ET.SubElement(inertial, "origin", xyz=numbers(center))
    ET.SubElement(inertial, "mass", value=repr(mass_kg))
    xx, yy, zz = map(repr, inertia_kg_m2)
    ET.SubElement(inertial, "inertia", ixx=xx, iyy=yy, izz=zz, ixy="0", ixz="0", iyz="0")


def _link(root: ET.Element, link: RobotLink, shape_file: str) -> None:
    element = ET.SubElement(root, "link", name=link.name)
    add_inertial(element, link.mass_kg, link.center_of_mass, link.inertia_kg_m2)
    collision = ET.SubElement(element, "collision")
    if shape_file:
        ET.SubElement(ET.SubElement(collision, "geometry"), "mesh", filename=shape_file)
        return
    if link.shape_center != _NOWHERE:
        ET.SubElement(collision, "origin", xyz=numbers(link.shape_center))
    add_shape(collision, link.shape)


def _joint(root: ET.Element, link: RobotLink) -> None:
    kind = "fixed" if link.motor is None else "continuous"
    joint = ET.SubElement(root, "joint", name=f"{link.name}_joint", type=kind)
    ET.SubElement(joint, "parent", link=BASE)
    ET.SubElement(joint, "child", link=link.name)
    ET.SubElement(joint, "origin", xyz=numbers(link.origin))
    ET.SubElement(joint, "axis", xyz="0 1 0")
    if link.motor is not None:
        ET.SubElement(joint, "dynamics", damping=repr(link.motor.damping_N_m_s_rad), friction="0")
