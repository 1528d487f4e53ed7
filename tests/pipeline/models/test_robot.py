"""The robot's files are read by PyBullet and yourdfpy, and held against the body that is simulated and closed forms."""

from math import cos, radians, sin, tan
from xml.etree import ElementTree as ET

import numpy as np
import pybullet
import pytest
import yourdfpy

from configs.draw import draw_run
from configs.loader import load_scenario
from physics.bullet.body import add_robot
from physics.bullet.world import connect
from pipeline.models.files import model_files
from pipeline.models.robot import frames
from sensors.effects.range_sensor.tof_mount_yaw import TofMountYaw
from symolo.core.geometry.poses import roll_pitch_yaw

ARMS = ("right_wheel", "left_wheel", "caster")
TOF = ("tof_front", "tof_left", "tof_right")


@pytest.fixture(scope="module")
def engine():
    client = connect(1000)
    yield client
    pybullet.disconnect(client)


@pytest.fixture(scope="module")
def ours(engine, spec) -> int:
    return add_robot(engine, spec.robot, (0.0, 0.0, 0.0), 0.001)[0]


@pytest.fixture(scope="module")
def urdf(engine, models) -> int:
    path = str(models / "robot.urdf")
    return pybullet.loadURDF(path, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=engine)


@pytest.fixture(scope="module")
def sdf(engine, models) -> int:
    (body,) = pybullet.loadSDF(str(models / "robot.sdf"), physicsClientId=engine)
    return body


def links(engine, body) -> dict[str, int]:
    joints = range(pybullet.getNumJoints(body, physicsClientId=engine))
    return {"base_link": -1} | {pybullet.getJointInfo(body, i, physicsClientId=engine)[12].decode(): i for i in joints}


def dynamics(engine, body, link) -> tuple[float, np.ndarray]:
    mass, _, inertia, *_ = pybullet.getDynamicsInfo(body, links(engine, body)[link], physicsClientId=engine)
    return mass, np.array(inertia)


def frame_axes(engine, body, link) -> tuple[np.ndarray, np.ndarray]:
    """Origin, and axes as columns, of a link's frame in R."""
    state = pybullet.getLinkState(body, links(engine, body)[link], physicsClientId=engine)
    return np.array(state[4]), np.array(pybullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)


@pytest.mark.parametrize("form", ["urdf", "sdf"])
def test_a_loaded_robot_weighs_what_the_simulated_one_does(engine, ours, form, request):
    loaded = request.getfixturevalue(form)
    for link in ("base_link", *ARMS):
        assert dynamics(engine, loaded, link)[0] == pytest.approx(dynamics(engine, ours, link)[0], rel=1e-12)
    total = sum(dynamics(engine, loaded, link)[0] for link in links(engine, loaded))
    assert total == pytest.approx(sum(dynamics(engine, ours, link)[0] for link in links(engine, ours)), abs=1e-7)


def test_a_loaded_robot_turns_as_the_simulated_one_but_for_the_rotors(engine, ours, urdf, spec):
    rotor = spec.robot.motor.rotor_inertia_kg_m2
    for link, extra in (("base_link", 0.0), ("right_wheel", rotor), ("left_wheel", rotor), ("caster", 0.0)):
        expected = dynamics(engine, ours, link)[1] - (0.0, extra, 0.0)
        assert dynamics(engine, urdf, link)[1] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("form", ["urdf", "sdf"])
def test_a_loaded_robot_takes_the_room_of_the_simulated_one(engine, ours, form, request):
    loaded = request.getfixturevalue(form)
    shift = 0.0
    if form == "sdf":  # PyBullet puts the base's centre of mass, not its frame, where a model of an SDF is
        shift = np.array(pybullet.getBasePositionAndOrientation(loaded, physicsClientId=engine)[0])
        shift = shift - pybullet.getBasePositionAndOrientation(ours, physicsClientId=engine)[0]
    for link in ("base_link", *ARMS):
        expected = np.array(pybullet.getAABB(ours, links(engine, ours)[link], physicsClientId=engine))
        box = np.array(pybullet.getAABB(loaded, links(engine, loaded)[link], physicsClientId=engine))
        assert box - shift == pytest.approx(expected, abs=1e-6)


def test_the_frame_of_the_camera_looks_along_its_axis(engine, urdf, spec):
    camera = spec.robot.camera
    down, left = radians(camera.pitch_down_deg), radians(camera.yaw_left_deg)
    ahead = [cos(down) * cos(left), cos(down) * sin(left), -sin(down)]
    place = [camera.x_m, camera.y_m, spec.robot.chassis.base_height_m + camera.height_above_base_m]
    origin, optical = frame_axes(engine, urdf, "camera_optical_frame")
    body_origin, body = frame_axes(engine, urdf, "camera_link")
    assert origin == pytest.approx(place, abs=1e-6)
    assert body_origin == pytest.approx(place, abs=1e-6)
    assert optical[:, 2] == pytest.approx(ahead, abs=1e-6)
    assert body == pytest.approx(np.column_stack([optical[:, 2], -optical[:, 0], -optical[:, 1]]), abs=1e-6)
    # Rolled clockwise as seen from behind by less than nothing: its right side points up.
    assert optical[2, 0] == pytest.approx(cos(down) * sin(-radians(camera.roll_deg)), abs=1e-6)


def test_the_frames_of_the_range_sensors_look_along_the_beams(engine, urdf, spec):
    mounts = spec.robot.tof.mounts
    effect = spec.robot.effects.get(TofMountYaw)
    assert effect.sensor == "front"
    for name, mount, extra in (("front", mounts.front, effect.angle_rad), ("left", mounts.left, 0.0)):
        yaw, up = radians(mount.yaw_deg) + extra, radians(mount.pitch_up_deg)
        origin, axes = frame_axes(engine, urdf, f"tof_{name}")
        assert origin == pytest.approx([mount.x_m, mount.y_m, mount.z_m], abs=1e-6)
        assert axes[:, 0] == pytest.approx([cos(up) * cos(yaw), cos(up) * sin(yaw), sin(up)], abs=1e-6)


@pytest.mark.filterwarnings("ignore:.*dump.concatenate=True:DeprecationWarning")  # of trimesh, at yourdfpy's way
def test_yourdfpy_finds_the_file_valid_and_two_joints_that_move(models, spec):
    robot = yourdfpy.URDF.load(str(models / "robot.urdf"))
    assert robot.validate()
    assert robot.actuated_joint_names == ["right_wheel_joint", "left_wheel_joint"]
    assert {*robot.link_map} == {"base_link", *ARMS, *TOF, "camera_link", "camera_optical_frame", "line_sensor"}
    line = spec.robot.line_sensor
    assert robot.get_transform("line_sensor", "base_link")[:3, 3] == pytest.approx([line.x_m, 0.0, line.height_m])


@pytest.fixture(scope="module")
def sensors(models) -> dict[str, ET.Element]:
    root = ET.parse(models / "robot.sdf")  # noqa: S314 - a file that was written above
    return {sensor.get("name"): sensor for sensor in root.iter("sensor")}


def value(element, path: str) -> float:
    return float(element.findtext(path))


def test_the_camera_of_the_sdf_has_the_lens_of_the_robot(sensors, spec):
    camera, lens = spec.robot.camera, sensors["camera"].find("camera")
    assert (value(lens, "image/width"), value(lens, "image/height")) == (64, 48)
    focal_px = 64 * camera.focal_length_mm / camera.sensor_width_mm
    assert value(lens, "lens/intrinsics/fx") == value(lens, "lens/intrinsics/fy") == pytest.approx(focal_px)
    assert focal_px == pytest.approx(32 / tan(0.5 * value(lens, "horizontal_fov")))
    # Gazebo counts from the edge of the first pixel: the middle of the image is at half its size.
    off_px = 64 * camera.principal_point_right_mm / camera.sensor_width_mm
    assert value(lens, "lens/intrinsics/cx") == pytest.approx(32 + off_px)
    assert value(lens, "lens/intrinsics/cy") == pytest.approx(24)
    assert value(lens, "distortion/k1") == camera.distortion.k1


def test_the_camera_of_the_sdf_does_not_see_its_own_robot(models, sensors):
    mask = int(sensors["camera"].findtext("camera/visibility_mask"))
    visuals = ET.parse(models / "robot.sdf").iter("visual")  # noqa: S314 - as above
    assert {int(visual.findtext("visibility_flags")) & mask for visual in visuals} == {0}


def test_a_range_sensor_of_the_sdf_covers_the_cone_with_no_fewer_rays(sensors, spec):
    tof = spec.robot.tof
    assert {name for name in sensors if name != "camera"} == {*TOF}
    scan = sensors["tof_left"].find("lidar/scan")
    samples = [value(scan, f"{way}/samples") for way in ("horizontal", "vertical")]
    assert samples[0] * samples[1] >= tof.rays
    for way in ("horizontal", "vertical"):
        angles = value(scan, f"{way}/max_angle"), value(scan, f"{way}/min_angle")
        assert angles == pytest.approx((radians(12.5), -radians(12.5)))
    limits = sensors["tof_left"].find("lidar/range")
    assert (value(limits, "min"), value(limits, "max")) == (tof.min_range_m, tof.max_range_m)


def test_the_drive_of_the_sdf_goes_by_what_the_board_knows(models, spec):
    drive = next(ET.parse(models / "robot.sdf").iter("plugin"))  # noqa: S314 - as above
    assert value(drive, "wheel_separation") == spec.robot.drive.track_m
    assert value(drive, "wheel_radius") == 0.5 * spec.robot.drive.wheel_diameter_m


def test_two_runs_of_a_fleet_have_two_robots():
    loaded = load_scenario("symolo", ["robot=fleet"])
    one, two = (model_files(draw_run(loaded, "CW", run), ("urdf",))["robot.urdf"] for run in (1, 2))
    assert one != two


@pytest.mark.parametrize("pitch_deg", [30.0, 90.0])
@pytest.mark.parametrize("roll_deg", [0.0, 20.0])
def test_angles_give_the_rotation_again_also_of_a_camera_that_looks_straight_down(spec, pitch_deg, roll_deg):
    camera = spec.robot.camera.model_copy(update={"pitch_down_deg": pitch_deg, "roll_deg": roll_deg})
    frame = next(f for f in frames(spec.robot.model_copy(update={"camera": camera})) if f.name == "camera_link")
    turned = np.array(pybullet.getMatrixFromQuaternion(pybullet.getQuaternionFromEuler(frame.placement.rpy)))
    axes = turned.reshape(3, 3)
    assert axes[:, 0] @ (0, 0, 1) == pytest.approx(-sin(radians(pitch_deg)), abs=1e-9)
    assert np.array(roll_pitch_yaw(axes)) == pytest.approx(np.array(frame.placement.rpy), abs=1e-6)
