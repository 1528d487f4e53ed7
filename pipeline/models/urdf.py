"""The robot as URDF: the simulated bodies, with visual shapes and frames of the sensors."""

from xml.etree import ElementTree as ET

from physics.robot.links import BASE
from physics.robot.urdf import add_inertial, add_shape, numbers, robot_element, urdf_text
from pipeline.models.geometry import CylinderShape, Placement, Visual
from pipeline.models.robot import NamedFrame, RobotParts

FRAME_MASS_KG = 1e-9
"""Mass of the frame of a sensor: PyBullet gives a link without mass 1 kg."""
_FRAME_INERTIA = (1e-15, 1e-15, 1e-15)


def robot_model_urdf(parts: RobotParts) -> bytes:
    """Return URDF 1.0 of base, wheels, caster, and a fixed link for the frame of each sensor."""
    root = robot_element(parts.config)
    # What the engine simulates and URDF cannot describe.
    right, left = (link.motor for link in parts.links if link.motor is not None)
    inertias = f"rotors and gears, {right.inertia_kg_m2!r} kg m2 right and {left.inertia_kg_m2!r} left"
    frictions = f"dry friction, {right.coulomb_N_m!r} N m right and {left.coulomb_N_m!r} left"
    root.insert(0, ET.Comment(f" not in the inertias: {inertias} "))
    root.insert(1, ET.Comment(f" not in the joints: {frictions} "))
    by_name = {element.get("name"): element for element in root.iter("link")}
    for link, visuals in parts.visuals.items():
        for visual in visuals:
            _visual(by_name[link], visual)
    for frame in parts.frames:
        _frame(root, frame)
    return urdf_text(root).encode()


def _visual(link: ET.Element, visual: Visual) -> None:
    element = ET.SubElement(link, "visual", name=visual.name)
    _origin(element, visual.placement)
    if isinstance(visual.shape, CylinderShape):
        size = {"radius": repr(visual.shape.radius_m), "length": repr(visual.shape.width_m)}
        ET.SubElement(ET.SubElement(element, "geometry"), "cylinder", size)
    else:
        add_shape(element, visual.shape)
    # Materials are known by name in the whole file: one for each visual, so that none is another's.
    material = ET.SubElement(element, "material", name=visual.name)
    ET.SubElement(material, "color", rgba=f"{numbers(visual.srgb)} 1")


def _frame(root: ET.Element, frame: NamedFrame) -> None:
    add_inertial(ET.SubElement(root, "link", name=frame.name), FRAME_MASS_KG, (0.0, 0.0, 0.0), _FRAME_INERTIA)
    joint = ET.SubElement(root, "joint", name=f"{frame.name}_joint", type="fixed")
    ET.SubElement(joint, "parent", link=BASE)
    ET.SubElement(joint, "child", link=frame.name)
    _origin(joint, frame.placement)


def _origin(parent: ET.Element, placement: Placement) -> None:
    ET.SubElement(parent, "origin", xyz=numbers(placement.xyz), rpy=numbers(placement.rpy))
