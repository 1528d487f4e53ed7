"""Meshes of users: every format gives the same body, and a file that is none is refused with its place and a cure."""

import base64
import zlib

import numpy as np
import pytest
import trimesh

from configs.assets.mesh_files import read_mesh
from configs.loader import load_section
from symolo.arena.mesh import MAX_TRIANGLES, TriangleMesh, unpacked
from symolo.core.errors import InputError

BODY = trimesh.creation.cone(0.2, 0.5, sections=12)
"""Its axis is z, its circle lies in z = 0."""


def exported(kind, body=BODY):
    options = {"embed_buffers": True} if kind == "gltf" else {}
    data = body.export(file_type=kind, **options)
    data = data["model.gltf"] if isinstance(data, dict) else data
    return data.encode() if isinstance(data, str) else data


@pytest.mark.parametrize("ending", [".stl", ".obj", ".glb", ".gltf"])
def test_every_format_gives_the_same_body(ending):
    mesh = read_mesh(exported(ending[1:]), ending, 2.0, "z")
    assert mesh.size == pytest.approx((0.8, 0.8, 1.0), rel=1e-2)
    assert mesh.vertices[:, 2].min() == 0.0
    corners = mesh.vertices[mesh.triangles]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    assert volume == pytest.approx(8.0 * BODY.volume, rel=1e-5)


def test_y_up_becomes_z_up_without_a_mirror_image():
    turned = BODY.copy()
    turned.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0)))  # z to y
    upright, laid = read_mesh(exported("glb", turned), ".glb", 1.0, "y"), read_mesh(exported("glb"), ".glb", 1.0, "z")
    np.testing.assert_allclose(np.sort(upright.vertices, axis=0), np.sort(laid.vertices, axis=0), atol=1e-6)


def test_a_packed_mesh_is_the_same_again():
    mesh = read_mesh(exported("stl"), ".stl", 1.0, "z")
    again = unpacked(mesh.packed())
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.triangles, mesh.triangles)


def packed(vertices, triangles, counts=None):
    counts = np.array(counts or (len(vertices), len(triangles)), "<u4")
    data = counts.tobytes() + np.array(vertices, "<f4").tobytes() + np.array(triangles, "<u4").tobytes()
    return base64.b64encode(zlib.compress(data)).decode()


@pytest.mark.parametrize(
    "text",
    [
        "not base64!",
        base64.b64encode(b"no zlib").decode(),
        base64.b64encode(zlib.compress(b"")).decode(),
        base64.b64encode(zlib.compress(b"\0" * 8)).decode(),
        packed([(0, 0, 0)] * 3, [(0, 1, 3)]),
        packed([(0, 0, float("nan"))] * 3, [(0, 1, 2)]),
        packed([(0, 0, 0)] * 3, [(0, 1, 2)], (3, 2)),
        packed([(0, 0, 0)] * 3, [(0, 1, 2)], (3, MAX_TRIANGLES + 1)),
        base64.b64encode(zlib.compress(b"\0" * 100_000_000, 1)).decode(),
        packed([(0, 0, 0)] * 3, [(0, 1, 2)])[:-8],
    ],
)
def test_a_packed_mesh_that_is_none_is_refused(text):
    with pytest.raises(ValueError, match="is no packed mesh"):
        unpacked(text)


def _arena(folder, mesh, more=""):
    path = folder / "arena.yaml"
    path.write_text(
        "extends: symolo\nname: mine\nassets: meshes\nobstacles:\n"
        f"  - {{name: thing, center: [0.0, 0.0], mesh: {mesh}{more}}}\n"
    )
    return str(path)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes/cone.stl").write_bytes(exported("stl"))
    (tmp_path / "meshes/many.stl").write_bytes(exported("stl", trimesh.creation.icosphere(subdivisions=6, radius=0.1)))
    (tmp_path / "meshes/thing.blend").write_bytes(b"BLENDER")
    (tmp_path / "meshes/bad.glb").write_bytes(b"glTF\2\0\0\0")
    (tmp_path / "meshes/apart.gltf").write_bytes(BODY.export(file_type="gltf")["model.gltf"])
    (tmp_path / "meshes/empty.obj").write_bytes(b"# nothing\n")
    (tmp_path / "secret.stl").write_bytes(exported("stl"))
    (tmp_path / "meshes/link.stl").symlink_to(tmp_path / "secret.stl")
    return tmp_path


def test_a_file_is_found_beside_its_arena_and_gives_the_size(folder):
    tree = load_section("arena", _arena(folder, "{file: cone.stl, scale: 0.5}")).tree
    assert "assets" not in tree
    (obstacle,) = tree["obstacles"]
    assert obstacle["size"] == pytest.approx([0.2, 0.2, 0.25], rel=1e-2)
    assert obstacle["mesh"]["packed"]


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        ("{file: cone.st}", r"has none of the endings \.glb, \.gltf, \.obj, \.stl"),
        ("{file: conus.stl}", "no such file in .*did you mean cone.stl"),
        ("{file: thing.blend}", r"has none of the endings.*save it as \.glb"),
        ("{file: ../secret.stl}", r"leads out of the folder of arena\.assets"),
        ("{file: link.stl}", r"is a link that leads out of the folder of arena\.assets"),
        ("{file: bad.glb}", "cannot be read as glb"),
        ("{file: apart.gltf}", r"refers to another file.*save it as one file, such as \.glb"),
        ("{file: empty.obj}", "has no triangles"),
        ("{file: many.stl}", "has 81920 triangles; at most 20000 can be used"),
        (
            "{file: cone.stl, scale: 100}",
            r"is 40 x 40 x 50 m; each length must be from 0\.002 to 20 m: got 'cone\.stl'; set mesh\.scale",
        ),
        ("{file: cone.stl, scale: {uniform: [1, 2]}}", "sizes follow from it"),
        ("{fil: cone.stl}", "unknown key.*did you mean file"),
        ("{file: cone.stl, packed: abc}", "allowed: a packed mesh"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_refused(folder, mesh, message):
    with pytest.raises(InputError, match=message):
        load_section("arena", _arena(folder, mesh))


def test_without_a_folder_the_message_says_how_to_name_it(folder):
    path = _arena(folder, "{file: cone.stl}")
    text = (folder / "arena.yaml").read_text()
    (folder / "arena.yaml").write_text(text.replace("assets: meshes\n", ""))
    with pytest.raises(InputError, match=r"there is no folder arena\.assets: .*name it, such as assets"):
        load_section("arena", path)


def test_a_mesh_has_arrays_that_nobody_can_change():
    mesh = TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0, 0] = 1.0
