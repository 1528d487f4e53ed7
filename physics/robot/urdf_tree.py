"""Bodies and joints of a URDF file in one frame, that of its root: https://wiki.ros.org/urdf/XML.

Only primitive shapes are read; a mesh has a place and no size. Joints are at zero.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.geometry.poses import transform_of

MAX_BYTES = 4 << 20
MAX_LINKS = 2000
MAX_NUMBER = 1e4
"""Largest length [m], mass [kg] or angle [rad] of a file; a larger one is a mistake."""
TURNING = frozenset({"continuous", "revolute"})


@dataclass(frozen=True)
class UrdfShape:
    """A box, a cylinder about z or a sphere, in the frame of the root."""

    kind: str
    """box, cylinder, sphere, or mesh."""
    size_m: tuple[float, ...]
    """Lengths of a box; radius and length of a cylinder; radius of a sphere; nothing for a mesh."""
    X_root: Array
    """(4, 4), pose of its middle."""

    def corners(self) -> Array:
        """Return points (N, 3) in the frame of the root whose box encloses the shape; none for a mesh."""
        match self.kind, self.size_m:
            case "box", (x, y, z):
                half = 0.5 * np.array([x, y, z])
            case "cylinder", (radius, length):
                half = np.array([radius, radius, 0.5 * length])
            case "sphere", (radius,):
                center = self.X_root[:3, 3]
                return np.stack([center - radius, center + radius])
            case _:
                return np.empty((0, 3))
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1)
        return (self.X_root[:3, :3] @ (half[:, None] * signs) + self.X_root[:3, 3:]).T


@dataclass(frozen=True)
class UrdfLink:
    """A rigid body of the file."""

    name: str
    X_root: Array
    """(4, 4), pose of its frame in that of the root."""
    mass_kg: float
    center_of_mass: Array
    """(3,) [m], in the frame of the root."""
    shapes: tuple[UrdfShape, ...]
    """Shapes of the collisions, or of the visuals where the link has none for collisions."""


@dataclass(frozen=True)
class UrdfJoint:
    """A joint between two bodies of the file."""

    name: str
    kind: str
    """Type in the file, such as `continuous` or `fixed`."""
    parent: str
    child: str
    axis: Array
    """(3,), unit vector in the frame of the root."""
    effort_N_m: float | None
    speed_rad_s: float | None
    """Limits of the joint, where the file has them."""


@dataclass(frozen=True)
class UrdfTree:
    """The whole file: bodies and joints by name, and settings of plug-ins."""

    name: str
    links: dict[str, UrdfLink]
    joints: tuple[UrdfJoint, ...]
    settings: dict[str, str]
    """Texts of plug-ins by their tags, the first of each, such as `wheel_separation` and `left_joint`."""
    largest_angle_rad: float = 0.0
    """Largest size of a roll, pitch or yaw in the file."""
    meshes: tuple[str, ...] = ()
    """Names of the files of meshes, each once."""
    inertias: int = 0
    """Number of links with moments of inertia."""


def read_urdf(data: bytes, where: str) -> UrdfTree:
    """Return the bodies of a URDF file.

    Raises:
        InputError: It is no URDF, has a document type, or its links are no tree.
    """
    # Entities could blow up or read other files; no URDF needs them.
    if len(data) > MAX_BYTES or b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise InputError("a URDF file", where=where, allowed=f"at most {MAX_BYTES >> 20} MiB, without a document type")
    try:
        root = ET.fromstring(data)  # noqa: S314 - without entities, which are refused above
    except ET.ParseError as error:
        raise InputError(f"no XML: {error}", where=where, allowed="a URDF file") from None
    if root.tag != "robot":
        cure = "convert xacro first: xacro FILE.xacro > FILE.urdf" if "xacro" in data[:2000].decode("latin-1") else ""
        raise InputError("the first tag", where=where, got=root.tag, allowed="robot, as in URDF", cure=cure)
    try:
        return _Reader(root, where).tree()
    except ValueError as error:
        raise InputError(f"a number cannot be read: {error}", where=where, allowed="URDF without xacro") from None


class _Reader:
    def __init__(self, root: ET.Element, where: str) -> None:
        self._root, self._where = root, where

    def tree(self) -> UrdfTree:
        links = {link.get("name", ""): link for link in self._root.findall("link")}
        if not links or len(links) > MAX_LINKS:
            raise InputError("links", where=self._where, got=len(links), allowed=f"1 to {MAX_LINKS}")
        joints = self._root.findall("joint")
        poses = self._poses(links, joints)
        plugins = [element for plugin in self._root.iter("plugin") for element in plugin]
        settings = {element.tag: (element.text or "").strip() for element in reversed(plugins)}
        return UrdfTree(
            self._root.get("name", ""),
            {name: _link(name, link, poses[name]) for name, link in links.items()},
            tuple(self._joint(joint, poses) for joint in joints),
            settings,
            max((np.abs(_numbers(rpy, 3)).max() for rpy in self._attributes("origin", "rpy")), default=0.0),
            tuple(dict.fromkeys(file.rpartition("/")[2] for file in self._attributes("mesh", "filename"))),
            sum(link.find("inertial/inertia") is not None for link in links.values()),
        )

    def _attributes(self, tag: str, name: str) -> Iterator[str]:
        return (text for element in self._root.iter(tag) if (text := element.get(name)))

    def _poses(self, links: dict[str, ET.Element], joints: list[ET.Element]) -> dict[str, Array]:
        below: dict[str, list[ET.Element]] = {}
        children: set[str] = set()
        for joint in joints:
            parent, child = _ends(joint)
            if parent not in links or child not in links or child in children:
                what = f"joint {joint.get('name')}: parent {parent}, child {child}"
                raise InputError(what, where=self._where, allowed="links of the file, each the child of one joint")
            below.setdefault(parent, []).append(joint)
            children.add(child)
        roots = [name for name in links if name not in children]
        if len(roots) != 1:
            raise InputError("links", where=self._where, got=f"{len(roots)} roots", allowed="one root, as in a tree")
        poses = {roots[0]: np.eye(4)}
        open_links = [roots[0]]
        while open_links:
            parent = open_links.pop()
            for joint in below.get(parent, ()):
                _, child = _ends(joint)
                poses[child] = poses[parent] @ _origin(joint)
                open_links.append(child)
        if cut_off := [name or "one without a name" for name in links if name not in poses]:
            what = f"links that no joint connects with {roots[0]}: {', '.join(cut_off[:5])}"
            raise InputError(what, where=self._where, allowed="one tree of links")
        return poses

    @staticmethod
    def _joint(joint: ET.Element, poses: dict[str, Array]) -> UrdfJoint:
        parent, child = _ends(joint)
        axis_element, limit = joint.find("axis"), joint.find("limit")
        axis = _numbers(axis_element.get("xyz", "1 0 0"), 3) if axis_element is not None else np.array([1.0, 0.0, 0.0])
        along = poses[child][:3, :3] @ axis
        length = float(np.linalg.norm(along))
        return UrdfJoint(
            joint.get("name", ""),
            joint.get("type", ""),
            parent,
            child,
            along / length if length else along,
            _positive(limit, "effort"),
            _positive(limit, "velocity"),
        )


def _ends(joint: ET.Element) -> tuple[str, str]:
    parent, child = joint.find("parent"), joint.find("child")
    return ("" if parent is None else parent.get("link", "")), ("" if child is None else child.get("link", ""))


def _link(name: str, link: ET.Element, X: Array) -> UrdfLink:
    inertial = link.find("inertial")
    mass_kg, center = 0.0, X[:3, 3]
    if inertial is not None:
        mass = inertial.find("mass")
        mass_kg = 0.0 if mass is None else _number(mass.get("value", "0"))
        center = (X @ _origin(inertial))[:3, 3]
    for tag in ("collision", "visual"):
        if shapes := tuple(_shapes(link, tag, X)):
            return UrdfLink(name, X, mass_kg, center, shapes)
    return UrdfLink(name, X, mass_kg, center, ())


def _shapes(link: ET.Element, tag: str, X: Array) -> Iterator[UrdfShape]:
    for element in link.findall(tag):
        geometry = element.find("geometry")
        pose = X @ _origin(element)
        for shape in geometry if geometry is not None else ():
            match shape.tag:
                case "box":
                    yield UrdfShape("box", tuple(_numbers(shape.get("size", ""), 3).tolist()), pose)
                case "cylinder":
                    size = (_number(shape.get("radius", "")), _number(shape.get("length", "")))
                    yield UrdfShape("cylinder", size, pose)
                case "sphere":
                    yield UrdfShape("sphere", (_number(shape.get("radius", "")),), pose)
                case "mesh":
                    yield UrdfShape("mesh", (), pose)


def _origin(element: ET.Element) -> Array:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = (_numbers(origin.get(name, "0 0 0"), 3).tolist() for name in ("xyz", "rpy"))
    return transform_of(tuple(xyz), tuple(rpy))


def _numbers(text: str, count: int) -> Array:
    values = [float(word) for word in text.split()]
    if len(values) != count or not all(abs(value) <= MAX_NUMBER for value in values):
        raise ValueError(f"{text[:60]!r}, {count} finite numbers were expected")
    return np.array(values)


def _number(text: str) -> float:
    return float(_numbers(text, 1)[0])


def _positive(limit: ET.Element | None, name: str) -> float | None:
    """Return a limit of a joint; None where it is missing, zero or beyond any small robot."""
    value = float(limit.get(name, "0")) if limit is not None else 0.0
    return value if 0.0 < value < 1000.0 else None
