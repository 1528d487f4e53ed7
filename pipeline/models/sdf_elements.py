"""Elements of SDF 1.9."""

from collections.abc import Mapping
from xml.etree import ElementTree as ET

from pipeline.models.geometry import Placement

VERSION = "1.9"


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
