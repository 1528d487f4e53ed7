"""Readers of meshes, drawings and robots from untrusted sources, as `readers.py` has them."""

from pathlib import Path

import cv2
import numpy as np
import trimesh

from configs.arena_import.floor_plan import drawing_from_image
from configs.arena_import.svg import drawing_from_svg
from configs.assets.mesh_files import FORMATS, read_mesh
from physics.robot.urdf_import import robot_from_urdf
from physics.robot.urdf_tree import read_urdf
from symolo.arena.mesh import unpacked
from tests.fuzz.guard import Read

EXAMPLES = Path(__file__).parents[2] / "examples"


def meshes() -> list[bytes]:
    """Return a body in each format, after a line with the ending of its name, and a packed one."""
    body = trimesh.creation.box((0.1, 0.2, 0.3))
    embedded = body.export(file_type="gltf", embed_buffers=True)["model.gltf"]
    files = {".stl": body.export(file_type="stl"), ".obj": body.export(file_type="obj").encode(), ".gltf": embedded}
    files[".glb"] = (EXAMPLES / "meshes/chair.glb").read_bytes()
    packed = read_mesh(files[".stl"], ".stl", 1.0, "z").packed().encode()
    return [ending.encode() + b"\n" + data for ending, data in files.items()] + [b"packed\n" + packed]


def mesh_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        ending, _, content = data.partition(b"\n")
        name = ending.decode(errors="replace")
        if name in FORMATS:
            read_mesh(content, name, 1.0, "z")
        else:
            unpacked(content.decode(errors="replace"))

    return read


_CURVE = b'<svg xmlns="http://www.w3.org/2000/svg" width="9cm" height="9cm"><path id="line" d="%s"/></svg>'


def drawing_of_many_curves() -> bytes:
    """Curves without a length, to which no arcs are fitted and which add no piece to the line."""
    return _CURVE % (b"M 0 10 C" + 6000 * b" 9 9 9 9 9 9")


def drawings() -> list[bytes]:
    plan = np.full((60, 80, 3), 255, np.uint8)
    cv2.rectangle(plan, (5, 5), (74, 54), (0, 0, 0), 4)
    bezier = _CURVE % b"M 0 10 C 10 0 20 0 30 10 S 40 60 50 50 Q 60 0 70 9"
    return [(EXAMPLES / "track.svg").read_bytes(), bezier, cv2.imencode(".png", plan)[1].tobytes()]


def drawing_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        if b"<svg" in data:
            drawing = drawing_from_svg(data, "plan.svg", None)
        else:
            drawing = drawing_from_image(data, "plan.png", 4.0)
        drawing.moved_to_middle().arena("mine", 0.15, 0.01)

    return read


def robots() -> list[bytes]:
    return [(EXAMPLES / "burger.urdf").read_bytes()]


def robot_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        robot_from_urdf(read_urdf(data, "robot.urdf"), "mine", "robot.urdf")

    return read
