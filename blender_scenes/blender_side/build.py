"""The scene in Blender: meshes, lights, sky and camera."""

import itertools
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from blender_scenes.blender_side.shaders import ShaderGraph, make_materials
from blender_scenes.blender_side.user_images import UserImages
from blender_scenes.scene.description import LightPanel, Mesh, Scene, Sky, Sun
from sensors.camera.lens_warp import pinhole_image
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.pinhole import Intrinsics

ROBOT = "R"
CAMERA = "C"


def start() -> None:
    """Load an empty file with factory settings."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


def build(scene: Scene, camera: Intrinsics, user_files: Path | None = None, *, caustics: bool = False) -> None:
    """Fill an empty Blender file. The robot's parts are children of an empty called `R`; the camera is called `C`.

    Moving obstacles have the names of `moving_name` and are placed for each view. The `pass_index` of a mesh is its
    number from 1, among the scene's meshes, the robot's and the moving ones in this order.

    Args:
        scene: Scene.
        camera: Camera.
        user_files: Folder of the user's files by their SHA-256.
        caustics: Whether gloss and glass throw light on matt surfaces.
    """
    user_images = UserImages(user_files)
    materials = make_materials(scene.surfaces, user_images, caustics=caustics)
    numbers = itertools.count(1)
    for mesh in scene.meshes:
        _mesh(mesh, materials).pass_index = next(numbers)
    robot = _place(ROBOT, None)
    for seen, parts in ((False, scene.robot), (True, scene.robot_in_sight)):
        for mesh in parts:
            part = _mesh(mesh, materials)
            part.parent, part.visible_camera, part.pass_index = robot, seen, next(numbers)
    for number, mesh in enumerate(scene.moving):
        placed = _mesh(mesh, materials)
        placed.name, placed.pass_index = moving_name(number), next(numbers)
    for panel in scene.panels:
        _panel(panel)
    if scene.sun is not None:
        _sun(scene.sun)
    _sky(scene.sky, user_images)
    _camera(camera)


def moving_name(number: int) -> str:
    """Return the name of the moving mesh `number`, from 0; the mesh's own name may exceed Blender's 63 bytes."""
    return f"moving_{number}"


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
    if data.validate():
        raise ValueError(f"mesh {mesh.name} is not valid geometry")
    return _place(mesh.name, data)


def _axes(right: tuple, up: tuple, center: tuple) -> Matrix:
    """Return the pose of a light, which shines along its local -z, the direction of right x up."""
    x, y = np.array(right, float), -np.array(up, float)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, y, np.cross(x, y)], axis=1)
    pose[:3, 3] = center
    return Matrix(pose.tolist())


def _panel(panel: LightPanel) -> None:
    light = bpy.data.lights.new(panel.name, "AREA")
    light.shape, light.size, light.size_y = "RECTANGLE", panel.width_m, panel.height_m
    peak = max(panel.radiance)
    light.color = [c / peak for c in panel.radiance]
    # A Lambertian emitter of radiance L over the area A has the power pi A L.
    light.energy = peak * np.pi * panel.width_m * panel.height_m
    made = _place(panel.name, light)
    made.matrix_world = _axes(panel.right, panel.up, panel.center)
    # Behind glass a camera ray counts as a transmission ray; the shadow rays that light the floor are another kind.
    made.visible_camera = made.visible_transmission = panel.seen


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


def _sky(sky: Sky, user_images: UserImages) -> None:
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.cycles.sampling_method = "NONE"
    world.cycles_visibility.diffuse = world.cycles_visibility.glossy = False
    world.use_nodes = True
    graph = ShaderGraph(world.node_tree)
    image = _shipped(sky.panorama) if sky.mean is None else user_images.panorama(sky.panorama)
    towards = graph.node("ShaderNodeTexCoord").outputs["Generated"]
    turned = graph.node("ShaderNodeMapping", Vector=towards, Rotation=(0.0, 0.0, -sky.yaw_rad))
    texture = graph.node("ShaderNodeTexEnvironment", Vector=turned.outputs[0])
    texture.image = image
    cut = graph.node("ShaderNodeVectorMath")
    cut.operation = "MINIMUM"
    graph.feed(cut.inputs[0], texture.outputs["Color"])
    cut.inputs[1].default_value = (sky.ceiling,) * 3
    tint = graph.node("ShaderNodeHueSaturation", Saturation=sky.saturation, Color=cut.outputs[0])
    shine = graph.node("ShaderNodeBackground", Color=tint.outputs[0], Strength=sky.gain)
    graph.node("ShaderNodeOutputWorld", Surface=shine.outputs[0])


def _shipped(panorama: str) -> bpy.types.Image:
    folder = Path(bpy.utils.system_resource("DATAFILES")) / "studiolights" / "world"
    image = bpy.data.images.load(str(folder / f"{panorama}.exr"))
    image.colorspace_settings.name = "Linear Rec.709"
    return image


def _camera(camera: Intrinsics) -> None:
    data = bpy.data.cameras.new(CAMERA)
    pinhole = pinhole_image(camera).camera
    data.clip_start, data.clip_end = 0.001, 1000.0
    bpy.context.scene.camera = _place(CAMERA, data)
    if pinhole.fisheye is not None:
        _fisheye(data, pinhole, pinhole.fisheye)
        return
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36.0
    data.lens = 36.0 * pinhole.fx_px / pinhole.width_px
    # Both are in widths of the image; Blender shifts the frame over the view, so the axis moves the other way.
    data.shift_x = (0.5 * (pinhole.width_px - 1) - pinhole.cx_px) / pinhole.width_px
    data.shift_y = (pinhole.cy_px - 0.5 * (pinhole.height_px - 1)) / pinhole.width_px


def _fisheye(data: bpy.types.Camera, camera: Intrinsics, lens: Fisheye) -> None:
    """Set an equidistant lens with its axis in the middle of the image.

    Cycles' polynomial lens takes the angle as -(k0 + k1 r + ...) of the distance r from the axis, in the unit of the
    sensor's width and height (kernel/camera/projection.h). Here the unit is the pixel. Its equidistant lens would
    stretch the image to its own proportions.
    """
    data.type, data.panorama_type = "PANO", "FISHEYE_LENS_POLYNOMIAL"
    # Blender's sensor is 1 to 100 mm long; the longer side of the image is 50 mm.
    per_px = 50.0 / max(camera.width_px, camera.height_px)
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width, data.sensor_height = per_px * camera.width_px, per_px * camera.height_px
    data.fisheye_fov = 2.0 * lens.half_field_rad
    data.fisheye_polynomial_k0 = data.fisheye_polynomial_k2 = data.fisheye_polynomial_k3 = 0.0
    data.fisheye_polynomial_k4 = 0.0
    data.fisheye_polynomial_k1 = -1.0 / (per_px * camera.fx_px)
