"""URDF files of other robots, with numbers that are known from their manuals or from our own configuration."""

import re
import shlex
from pathlib import Path

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario, load_section, section_of
from physics.robot.urdf_import import robot_from_urdf
from physics.robot.urdf_tree import read_urdf
from pipeline.models.files import model_files
from symolo.core.errors import InputError

# Measures of a TurtleBot3 Burger (ROBOTIS e-Manual): wheels of 66 mm, 160 mm apart, 138 x 178 x 192 mm, about 1 kg.
BURGER = (Path(__file__).parents[3] / "examples/burger.urdf").read_text()


ROUND = "".join(
    f'<link name="{one}"/><joint name="to_{one}" type="fixed"><parent link="{other}"/><child link="{one}"/></joint>'
    for one, other in (("front", "rear"), ("rear", "front"))
)
"""Two links, each the child of the other."""


def imported(text, **options):
    return robot_from_urdf(read_urdf(text.encode(), "robot.urdf"), "mine", "robot.urdf", **options)


def test_a_robot_of_two_wheels_and_a_caster_has_the_measures_of_its_manual():
    robot = imported(BURGER)
    section = section_of("robot", robot.settings, "robot.urdf").tree
    drive, chassis, camera = section["drive"], section["chassis"], section["camera"]
    assert (drive["track_m"], drive["wheel_diameter_m"], drive["wheel_width_m"]) == (0.16, 0.066, 0.018)
    assert (drive["wheel_mass_kg"], drive["caster_x_m"], drive["caster_radius_m"]) == (0.03, -0.081, 0.005)
    # The centre of the masses of base and caster, and the box around them with the axle in its middle.
    assert chassis["mass_kg"] == 0.805
    assert chassis["center_of_mass_x_m"] == pytest.approx(-(0.8 * 0.032 + 0.005 * 0.081) / 0.805, rel=1e-5)
    assert chassis["length_m"] == pytest.approx(2 * (0.032 + 0.07), abs=1e-4)
    assert chassis["width_m"] == pytest.approx(0.16 + 0.018, abs=1e-4)
    assert chassis["clearance_m"] == pytest.approx(0.010 + 0.070 - 0.143 / 2)
    assert chassis["base_height_m"] + camera["height_above_base_m"] == pytest.approx(0.17)
    assert camera["pitch_down_deg"] == pytest.approx(30.0, abs=1e-3)
    # Gains follow from the size, which is that of the track.
    nominal = load_section("robot", "nominal").tree
    speed = nominal["controller"]["line"]["k1_m_s"] * (0.16 / 0.14) ** 0.5
    assert section["controller"]["line"]["k1_m_s"] == pytest.approx(speed, rel=1e-4)
    text = " ".join(robot.read)
    assert "track 0.16 m" in text
    assert any("motors" in line for line in robot.assumed)
    assert any("scaled by 1.14286" in line for line in robot.assumed)


def test_our_own_robot_comes_back_from_its_urdf():
    spec = draw_run(load_scenario("symolo", ["robot=nominal"]), "CW", 1)
    text = model_files(spec, ("urdf",))["robot.urdf"].decode()
    robot = section_of("robot", imported(text).settings, "robot.urdf").tree
    nominal = load_section("robot", "nominal").tree
    for section, names in (
        ("drive", ("track_m", "wheel_diameter_m", "wheel_mass_kg", "caster_x_m", "caster_radius_m")),
        ("chassis", ("length_m", "width_m", "clearance_m", "center_of_mass_x_m", "center_of_mass_z_m")),
        ("camera", ("x_m", "y_m", "pitch_down_deg")),
    ):
        for name in names:
            assert robot[section][name] == pytest.approx(nominal[section][name], abs=1e-4), f"{section}.{name}"
    assert robot["chassis"]["mass_kg"] == pytest.approx(nominal["chassis"]["mass_kg"], abs=0.002)  # the ball's 1 g
    assert robot["controller"] == nominal["controller"]


def test_links_of_sensors_and_of_nothing_are_listed_with_their_places():
    links = {
        "base_scan": "<inertial><mass value='0.1'/></inertial>",
        "imu_link": "",
        "beacon": "",
    }
    added = "".join(
        f"<link name='{name}'>{content}</link><joint name='to_{name}' type='fixed'><parent link='base_link'/>"
        f"<child link='{name}'/><origin xyz='-0.032 0.01 0.172'/></joint>"
        for name, content in links.items()
    )
    robot = imported(BURGER.replace("</robot>", added + "</robot>"))
    # The base is 10 mm above the floor, and the axle in the middle of the base's frame.
    place, cure = "at x -0.032 m, y 0.01 m, z 0.182 m", "sensors are keys of robot.sensors"
    assert robot.ignored == [
        f"link base_scan {place}: gives the body mass and shape, and is no sensor; {cure}",
        f"link imu_link {place}: has neither mass nor shape; {cure}",
        f"link beacon {place}: has neither mass nor shape; {cure}",
    ]
    assert imported(BURGER).ignored == []


def test_limits_of_the_joints_are_motors():
    limited = BURGER.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><limit effort="0.5" velocity="12"/>')
    robot = imported(limited)
    motor = robot.settings["motor"]
    # The motor equation without load and at rest, at 6 V.
    assert 6.0 / motor["torque_constant_N_m_A"] == pytest.approx(12.0)
    assert 6.0 / motor["winding_resistance_ohm"] * motor["torque_constant_N_m_A"] == pytest.approx(0.5, rel=1e-4)


def test_a_plug_in_names_wheels_that_are_meshes():
    text = BURGER.replace('<cylinder length="0.018" radius="0.033"/>', '<mesh filename="package://x/wheel.stl"/>')
    text = text.replace("wheel_left_joint", "port").replace("wheel_right_joint", "starboard")
    plugin = (
        "<gazebo><plugin filename='libdiff.so'><left_joint>port</left_joint><right_joint>starboard</right_joint>"
        "<wheel_radius>0.033</wheel_radius></plugin></gazebo></robot>"
    )
    robot = imported(text.replace("</robot>", plugin))
    assert robot.settings["drive"]["wheel_diameter_m"] == pytest.approx(0.066)
    assert any("width of the wheels" in line for line in robot.assumed)
    with pytest.raises(InputError, match=r"0 pairs of wheels.*--wheels LEFT,RIGHT; joints .* are port, starboard$"):
        imported(text)
    with pytest.raises(InputError, match=r"wheel wheel_left_link: no cylinder and no sphere.*wheel_radius"):
        imported(text, wheels=("port", "starboard"))
    for radius in ("${r}", "nan", "-0.033"):
        with pytest.raises(InputError, match=r"wheel_radius: got .*, allowed: a length in metres, from 0.001 to 1"):
            imported(text.replace("</robot>", plugin.replace("0.033", radius)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "no XML"),
        ("<sdf/>", "the first tag: got 'sdf', allowed: robot"),
        ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "without a document type"),
        ("<robot/>", "links: got 0"),
        (BURGER.replace('child link="camera_link"', 'child link="base_link"'), "each the child of one joint"),
        (BURGER.replace('radius="0.033"', 'radius="${r}"'), r"a number cannot be read.*without xacro"),
        (re.sub(r'xyz="0.0 -0.08 0.023"', 'xyz="nan 0 0"', BURGER), "3 finite numbers"),
        (BURGER.replace("wheel_right_joint", "other"), "0 pairs of wheels"),
        (BURGER.replace('xyz="0.0 -0.08 0.023"', 'xyz="0.0 0.08 0.223"'), "two wheels side by side, on one level axle"),
        (BURGER.replace("</robot>", ROUND + "</robot>"), "no joint connects with base_footprint: front, rear"),
    ],
)
def test_a_file_that_is_not_such_a_robot_is_refused(text, message):
    with pytest.raises(InputError, match=message):
        imported(text)


def test_four_driven_wheels_are_refused():
    text = BURGER.replace(
        "</robot>",
        "".join(
            f'<joint name="rear_{side}_joint" type="continuous"><parent link="base_link"/><child link="rear_{side}"/>'
            f'<origin xyz="-0.1 {y} 0.023" rpy="-1.5707963 0 0"/><axis xyz="0 0 1"/></joint><link name="rear_{side}"/>'
            for side, y in (("left", 0.08), ("right", -0.08))
        )
        + "</robot>",
    )
    with pytest.raises(InputError, match=r"2 pairs of wheels.*four driven wheels cannot be simulated"):
        imported(text)


def test_the_command_writes_a_robot_that_drives(tmp_path, symolo):
    (tmp_path / "burger.urdf").write_text(BURGER)
    out = tmp_path / "burger.yaml"
    ended = symolo("robot", "import", tmp_path / "burger.urdf", "--out", out)
    assert ended.code == 0
    assert "read:\n  - wheels wheel_left_joint and wheel_right_joint" in ended.out
    assert out.read_text().startswith("# Imported from burger.urdf.\n# Read:\n")
    assert load_section("robot", str(out)).tree["name"] == "burger"
    changed = out.read_text() + "# changed by hand\n"
    out.write_text(changed)
    again = symolo("robot", "import", tmp_path / "burger.urdf", "--out", out)
    assert (again.code, out.read_text()) == (2, changed)
    assert "exists already; name another file with --out" in again.err
    _, command, _ = ended.out.split("`")
    words = shlex.split(command)
    # The track is 8/7 of that of the nominal robot, for which arena and start were made.
    assert words[:3] == ["symolo", "simulate", "smoke"]
    assert {"arena={extends: symolo, scale: 1.14286}", f"robot={out}"} < {*words}
    assert "start: {x_m: 0.6286, y_m: -0.2286, yaw_deg: -90}" in command
    settings = ["--set=stop.lap=false", "--set=stop.time_limit_s=1", "--workers=1"]
    assert symolo(*words[1:-1], tmp_path / "data", *settings).code == 0
    assert symolo("robot", "import", tmp_path / "burger.urdf", "--out", tmp_path / "x.yaml", "--wheels=a").code == 2
    shown = symolo("robot", "show", "micromouse")
    assert "track_m: 0.07\n" in shown.out


def test_meshes_and_inertias_that_are_not_used_are_listed():
    mesh = '<visual><geometry><mesh filename="package://burger/meshes/hull.stl"/></geometry></visual>'
    inertial = '<inertial><mass value="0.8"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    part = f'<link name="part">{inertial}{mesh}</link><joint name="to_part" type="fixed"><parent link="base_link"/>'
    robot = imported(BURGER.replace("</robot>", f'{part}<child link="part"/></joint></robot>'))
    assert robot.ignored == [
        "meshes, of which no size is read: hull.stl; body.mesh takes a file",
        "moments of inertia of 1 link: they follow from masses and sizes",
    ]


def test_a_right_file_gives_no_suspicion():
    assert imported(BURGER).suspicious == []
    assert imported(BURGER, wheels=("wheel_left_joint", "wheel_right_joint")).suspicious == []


def test_wheels_in_another_order_than_their_names_and_places_are_suspicious():
    (text,) = imported(BURGER, wheels=("wheel_right_joint", "wheel_left_joint")).suspicious
    assert text.startswith("wheel_right_joint is taken for the left wheel, but its name says right;")
    unnamed = BURGER.replace("wheel_left_joint", "port").replace("wheel_right_joint", "starboard")
    (text,) = imported(unnamed, wheels=("starboard", "port")).suspicious
    assert text.startswith("starboard is taken for the left wheel, but it lies on the right in the file, at y -0.08 m;")


def test_lengths_in_millimetres_are_named():
    text = re.sub(r'xyz="([^"]*)"', lambda m: f'xyz="{" ".join(f"{1000 * float(v):g}" for v in m[1].split())}"', BURGER)
    with pytest.raises(InputError, match=r"distance of the wheels: got '160 m'.*in millimetres, divide them by 1000"):
        imported(text.replace('1000"/>', '1"/>'))


def test_angles_in_degrees_and_speeds_in_rpm_are_named():
    camera = '<joint name="c" type="fixed"><parent link="base_link"/><child link="eye"/><origin rpy="0 23 0"/></joint>'
    text = BURGER.replace("</robot>", f'<link name="eye"/>{camera}</robot>')
    assert imported(text).suspicious == [
        "rpy has angles up to 23, and a URDF has radians: if they are degrees, 23 is 0.4014"
    ]
    limited = BURGER.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><limit effort="0.5" velocity="171"/>')
    assert imported(limited).suspicious == [
        "velocity 171 of the wheels gives 5.64 m/s, and a URDF has rad/s: if it is in rpm, 171 is 17.91"
    ]
    degrees = BURGER.replace("-1.5707963", "-90")
    with pytest.raises(InputError, match=r"0 pairs of wheels.*rpy has angles up to 90.*90 is 1\.5708"):
        imported(degrees)
