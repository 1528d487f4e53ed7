"""The scene's description built in Blender: meshes, lights, sky and camera."""

from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from blender_scenes.bpy_side.shaders import material
from blender_scenes.colour import LUMINANCE
from blender_scenes.description import Intrinsics, Mesh, Panel, Portal, Scene, Sky, Sun

ROBOT = "R"
CAMERA = "C"


def start() -> None:
    """An empty file with nobody's preferences."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


def build(scene: Scene, camera: Intrinsics) -> None:
    """Fills an empty Blender file; the robot hangs on an empty called `R`, the camera is called `C`."""
    materials = {surface.name: material(surface) for surface in scene.surfaces}
    for mesh in scene.meshes:
        _mesh(mesh, materials)
    robot = _place(ROBOT, None)
    for mesh in scene.robot:
        _mesh(mesh, materials).parent = robot
    for panel in scene.panels:
        _panel(panel)
    for portal in scene.portals:
        _portal(portal)
    if scene.sun is not None:
        _sun(scene.sun)
    _sky(scene.sky)
    _camera(camera)


def _place(name: str, data: bpy.types.ID | None) -> bpy.types.Object:
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def _mesh(mesh: Mesh, materials: dict[str, bpy.types.Material]) -> bpy.types.Object:
    data = bpy.data.meshes.new(mesh.name)
    data.from_pydata(mesh.vertices, [], mesh.faces)
    uv = data.uv_layers.new(name="uv_m")
    uv.data.foreach_set("uv", np.array([c for face in mesh.uv_m for c in face], np.float32).ravel())
    slots = list(dict.fromkeys(mesh.face_surface))
    for name in slots:
        data.materials.append(materials[name])
    data.polygons.foreach_set("material_index", [slots.index(name) for name in mesh.face_surface])
    data.polygons.foreach_set("use_smooth", [mesh.smooth] * len(mesh.faces))
    if data.validate():
        raise ValueError(f"mesh {mesh.name} is not valid geometry")
    made = _place(mesh.name, data)
    made.visible_camera = mesh.seen_by_camera
    return made


def _axes(right: tuple, up: tuple, center: tuple) -> Matrix:
    """A light's local frame: it shines along its own -z, which is right x up."""
    x, y = np.array(right, float), -np.array(up, float)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, y, np.cross(x, y)], axis=1)
    pose[:3, 3] = center
    return Matrix(pose.tolist())


def _area(shape: Panel | Portal) -> bpy.types.Object:
    light = bpy.data.lights.new(shape.name, "AREA")
    light.shape, light.size, light.size_y = "RECTANGLE", shape.width_m, shape.height_m
    made = _place(shape.name, light)
    made.matrix_world = _axes(shape.right, shape.up, shape.center)
    made.visible_camera = False
    return made


def _panel(panel: Panel) -> None:
    light = _area(panel).data
    peak = max(panel.radiance)
    light.color = [c / peak for c in panel.radiance]
    # Cycles gives an area light of P watts the radiance P / (pi area), times 4 / 4: a Lambertian emitter.
    light.energy = peak * np.pi * panel.width_m * panel.height_m


def _portal(portal: Portal) -> None:
    _area(portal).data.cycles.is_portal = True


def _sun(sun: Sun) -> None:
    light = bpy.data.lights.new("sun", "SUN")
    peak = max(sun.irradiance)
    light.color, light.energy = [c / peak for c in sun.irradiance], peak
    light.angle = sun.angular_diameter_rad
    z = np.array(sun.towards)
    x = np.cross((0.0, 0.0, 1.0), z) if abs(z[2]) < 0.999 else np.array([1.0, 0, 0])
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    _place("sun", light).matrix_world = Matrix(pose.tolist())


def _sky(sky: Sky) -> None:
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    folder = Path(bpy.utils.system_resource("DATAFILES")) / "studiolights" / "world"
    image = bpy.data.images.load(str(folder / f"{sky.panorama}.exr"))
    image.colorspace_settings.name = "Linear Rec.709"
    coordinate, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, sky.yaw_rad)
    texture, tint = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMix")
    texture.image = image
    tint.data_type, tint.blend_type = "RGBA", "MULTIPLY"
    tint.inputs[0].default_value = 1.0
    tint.inputs[7].default_value = (*sky.tint, 1.0)
    shine, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    shine.inputs["Strength"].default_value = sky.mean_radiance / _upper_luminance(image)
    tree.links.new(coordinate.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tint.inputs[6])
    tree.links.new(tint.outputs[2], shine.inputs["Color"])
    tree.links.new(shine.outputs["Background"], output.inputs["Surface"])


def _upper_luminance(image: bpy.types.Image) -> float:
    """Mean luminance of a panorama above the horizon, by solid angle."""
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    luminance = pixels.reshape(height, width, 4)[..., :3] @ LUMINANCE
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    weight = np.where(elevation > 0, np.cos(elevation), 0.0)
    return float(luminance.mean(axis=1) @ weight / weight.sum())


def _camera(camera: Intrinsics) -> None:
    data = bpy.data.cameras.new(CAMERA)
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36.0
    data.lens = 36.0 * camera.fx_px / camera.width_px
    data.clip_start, data.clip_end = 0.001, 1000.0
    bpy.context.scene.camera = _place(CAMERA, data)
