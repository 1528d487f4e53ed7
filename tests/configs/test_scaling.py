"""A scaled robot is dynamically similar: its numbers follow from lengths, times and masses alone."""

import math

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario, load_section, section_of
from pipeline.stages.simulate import simulate
from symolo.core.errors import InputError

NOMINAL = load_section("robot", "nominal").tree


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_every_number_has_the_power_of_its_unit(scale):
    robot = section_of("robot", {"extends": "nominal", "scale": scale}, "test").tree
    expected = {  # length L, time L^1/2, mass L^3, voltage unchanged
        ("chassis", "length_m"): 1,
        ("chassis", "mass_kg"): 3,
        ("motor", "rotor_inertia_kg_m2"): 3 + 2,
        ("motor", "coulomb_friction_N_m"): 3 + 1 - 2 * 0.5 + 1,
        ("motor", "viscous_friction_N_m_s_rad"): 4 + 0.5,
        ("motor", "torque_constant_N_m_A"): 0.5,
        ("motor", "winding_resistance_ohm"): 0.5 - 4,
        ("wheel_loop", "integral_V_rad"): 0,
        ("wheel_loop", "proportional_V_s_rad"): 0.5,
        ("controller", "line", "k1_m_s"): 1 - 0.5,
        ("controller", "line", "k2_rad_s"): -0.5,
        ("controller", "wall", "error_scale_per_m"): -1,
        ("controller", "avoidance", "side_m"): 1,
        ("controller", "avoidance", "points"): 0,
        ("tof", "mounts", "left", "y_m"): 1,
        ("tof", "max_range_m"): 0,
        ("tof", "field_of_view_deg"): 0,
        ("encoder", "counts_per_revolution"): 0,
        ("power", "battery_voltage_V"): 0,
        ("camera", "height_above_base_m"): 1,
        ("camera", "focal_length_mm"): 0,
    }
    for path, power in expected.items():
        was, now = NOMINAL, robot
        for key in path:
            was, now = was[key], now[key]
        assert now == pytest.approx(was * scale**power, rel=1e-5), path
    # Relative to the weight on its wheels a scaled motor is as strong, and relative to sqrt(g l) it is as fast.
    assert _strength(robot) == pytest.approx(_strength(NOMINAL), rel=1e-4)
    assert _froude_number(robot) == pytest.approx(_froude_number(NOMINAL), rel=1e-4)


def _strength(robot):
    torque_N_m = 6.0 * robot["motor"]["torque_constant_N_m_A"] / robot["motor"]["winding_resistance_ohm"]
    return torque_N_m / (9.81 * robot["chassis"]["mass_kg"] * robot["drive"]["wheel_diameter_m"])


def _froude_number(robot):
    speed_m_s = 0.5 * robot["drive"]["wheel_diameter_m"] * 6.0 / robot["motor"]["torque_constant_N_m_A"]
    return speed_m_s / math.sqrt(9.81 * robot["chassis"]["length_m"])


def test_defaults_and_lists_of_an_arena_are_scaled_and_what_the_file_sets_is_not():
    arena = section_of("arena", {"extends": "moving", "scale": 0.5, "line": {"width_m": 0.01}}, "test").tree
    was = load_section("arena", "moving").tree
    assert arena["line"]["width_m"] == 0.01
    assert arena["floor"]["half_extent_m"] == 0.5 * was["floor"]["half_extent_m"]
    assert arena["floor"]["reflectance"] == was["floor"]["reflectance"]
    for now, before in zip(arena["walls"], was["walls"], strict=True):
        assert now["height_m"] == 0.5 * before["height_m"]
        assert now["start"] == pytest.approx([0.5 * x for x in before["start"]], rel=1e-5)
    (now, *_), (before, *_) = arena["obstacles"], was["obstacles"]
    assert now["size"] == pytest.approx([0.5 * x for x in before["size"]])
    assert now["yaw_deg"] == before["yaw_deg"]


def test_a_distribution_is_scaled_as_its_number_would_be():
    loaded = load_scenario("smoke", ["robot.chassis.mass_kg={uniform: [0.8, 1.0]}"])
    tree = {**loaded.tree["robot"], "chassis": {**loaded.tree["robot"]["chassis"], "mass_kg": {"uniform": [0.8, 1.0]}}}
    assert tree["chassis"]["mass_kg"] == {"uniform": [0.8, 1.0]}
    robot = section_of("robot", {"extends": "fleet", "scale": 2.0}, "test").tree
    was = load_section("robot", "fleet").tree
    assert robot["effects"] == was["effects"], "effects are factors and settings of single robots"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"scale": 2.0}, "scale; name the robot that it scales: extends"),
        ({"extends": "nominal", "scale": 20.0}, r"scale: got 20\.0, allowed: a number from 0\.1 to 10"),
        ({"extends": "nominal", "scale": {"uniform": [1, 2]}}, "without a distribution"),
        ({"extends": "nominal", "scale": True}, "scale: got true"),
    ],
)
def test_a_scale_that_is_none_is_refused(settings, message):
    with pytest.raises(InputError, match=message):
        section_of("robot", settings, "test")


def test_a_look_has_no_size():
    with pytest.raises(InputError, match="scale; leave it out: only arena and robot have a size"):
        section_of("look", {"extends": "lab", "scale": 2.0}, "test")


@pytest.mark.parametrize(("name", "scale", "route"), [("micromouse", 0.5, "CW"), ("scout", 1.944, "CCW")])
def test_a_scaled_robot_drives_the_same_lap_in_the_time_of_its_scale(name, scale, route):
    """Without noise the paths would be equal; a lap of the nominal robot takes 37.85 or 37.7 s (docs/hil.md)."""
    alone = [f"robot.sensors.{sensor}=null" for sensor in load_scenario(name).tree["robot"].get("sensors", {})]
    outcome = simulate(draw_run(load_scenario(name, ["seed=3", *alone]), route, 1))
    assert not outcome.problems
    assert outcome.lap_time_s == pytest.approx(37.8 * math.sqrt(scale), rel=0.02)
    # The line and the walls reach as much further from the origin.
    reach_m = abs(outcome.recording.trajectory.pose[:, :2]).max(axis=0)
    assert reach_m == pytest.approx([scale * 0.87, scale * 1.06], rel=0.1)


def test_further_sensors_are_moved_but_are_the_same_devices(tmp_path):
    sensors = """
sensors:
  lidar: {x_m: 0.02, max_range_m: 6, noise_m: 0.004}
  imu: {z_m: {uniform: [0.04, 0.06]}}
  line_array: {places: [[0.01, 0.0], [0.0, -0.02]], pitch_m: 0.01}
"""
    (tmp_path / "sensing.yaml").write_text(f"extends: nominal\nname: sensing\n{sensors}")
    (tmp_path / "large.yaml").write_text("extends: sensing.yaml\nname: large\nscale: 2.0\n")
    scaled = load_section("robot", str(tmp_path / "large.yaml")).tree["sensors"]
    assert (scaled["lidar"]["x_m"], scaled["lidar"]["max_range_m"], scaled["lidar"]["noise_m"]) == (0.04, 6, 0.004)
    assert scaled["imu"]["z_m"] == {"uniform": [0.08, 0.12]}
    assert scaled["line_array"]["places"] == [[0.02, 0.0], [0.0, -0.04]]
    assert scaled["line_array"]["pitch_m"] == 0.01
