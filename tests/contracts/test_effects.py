"""What holds for every effect, of physics and of sensors alike."""

from itertools import product
from pathlib import Path

import pytest
import yaml

from configs.draw import draw_robot
from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from physics.effects.gear_backlash import GearBacklash
from physics.robot.model import RobotModel
from symolo.core.errors import InputError

ROOT = Path(__file__).parents[2]
BY_NAME = EFFECTS.by_name()
CANONICAL = {
    "winding_resistance_scale": "scale",
    "torque_constant_scale": "scale",
    "torque_constant_mismatch": "mismatch",
    "viscous_friction_scale": "scale",
    "coulomb_friction_scale": "scale",
    "rotor_inertia_scale": "scale",
    "stribeck_friction": "extra_torque_N_m, stribeck_speed_rad_s",
    "quadratic_drag": "coefficient_N_m_s2_rad2",
    "torque_ripple": "amplitude_N_m, cycles_per_turn, phase_rad",
    "friction_asymmetry": "asymmetry",
    "friction_warmup": "amplitude, time_constant_s",
    "bridge_voltage_drop": "drop_V",
    "bridge_coast": "inductance_H, diode_V, switching_Hz",
    "supply_sag": "source_resistance_ohm",
    "battery_decline": "fraction_per_minute",
    "input_delay": "delay_s",
    "actuator_lag": "time_constant_s",
    "current_limit": "limit_A",
    "gear_backlash": "gap_rad",
    "current_sensor_offset": "offset_A",
    "current_sensor_gain": "gain",
    "speed_scale": "scale",
    "speed_filter_lag": "time_constant_s",
    "speed_time_offset": "delay_s",
    "range_signal_weighting": "exponent",
    "range_gathering_time": "duration_s",
    "range_wander": "sd_m, time_constant_s",
    "range_offset": "offset_m",
    "range_scale": "scale",
    "log_range_error": "coefficient_m",
    "temperature_drift": "coefficient_m_per_K",
    "material_bias": "material, offset_m",
    "material_slope": "material, coefficient",
    "incidence_bias": "coefficient",
    "tilt_asymmetry": "axis, coefficient_m_per_rad",
    "cover_crosstalk": "strength_per_m2",
    "near_field_error": "amplitude_m, decay_length_m",
    "range_saturation": "saturation_m",
    "warmup_drift": "amplitude_m, time_constant_s",
    "noise_scale": "scale",
    "ambient_noise": "coefficient_per_klux",
    "wheel_radius_scale": "scale",
    "wheel_radius_asymmetry": "asymmetry",
    "wheelbase_scale": "scale",
    "encoder_ticks_scale": "scale",
    "encoder_missed_ticks": "side, fraction, threshold_rad_s",
    "wheel_eccentricity": "side, amplitude, phase_rad",
    "floor_slope": "gradient, direction_rad",
    "turn_slip": "coefficient_s2_m",
    "line_lateral_offset": "offset_m",
    "line_height": "height_scale",
    "line_crosstalk": "share",
    "line_gain": "channel, scale",
    "line_ambient": "offset",
    "line_offset": "channel, offset",
    "line_adc_saturation": "low, high",
    "marker_offset": "offset_m",
    "marker_yaw": "angle_rad",
    "pose_clock_drift": "rate",
    "pose_time_offset": "delay_s",
    "tof_range_offset": "sensor, offset_m",
    "tof_range_scale": "scale",
    "tof_mount_yaw": "sensor, angle_rad",
    "tof_time_offset": "delay_s",
}
"""Names and parameters, written by hand: measured cases and stored answers name them, so a change must be noticed."""

CHOICES = {"material": ("white_board",)}
CASES = [
    pytest.param(effect, dict(zip(effect.options(), choice, strict=True)), id="-".join((effect.name, *choice)))
    for effect in BY_NAME.values()
    for choice in product(*(CHOICES.get(name, options) for name, options in effect.options().items()))
]
UNITS = {"N m": "N_m", "rad/s": "rad_s", "N m s2/rad2": "N_m_s2_rad2", "V": "V", "ohm": "ohm", "1/min": "per_minute"}
UNITS |= {"s": "s", "A": "A", "rad": "rad", "m": "m", "m/K": "m_per_K", "1/m2": "per_m2", "1/klux": "per_klux"}
UNITS |= {"s2/m": "s2_m", "m/rad": "m_per_rad", "H": "H", "Hz": "Hz"}


def test_the_effects_are_those_of_the_shared_format():
    assert {name: ", ".join(effect.model_fields) for name, effect in BY_NAME.items()} == CANONICAL
    assert len(BY_NAME) == len(EFFECTS.classes())


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_a_effect_has_a_file_of_its_name_a_cause_and_an_excitation(effect):
    assert effect.__module__.rsplit(".", 1)[1] == effect.name
    assert len(effect.cause) > 10
    assert len(effect.excitation) > 10


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_bounds_are_finite_and_hold_null_and_start(effect):
    assert effect.parameters()
    for name, number in effect.parameters().items():
        assert -1e5 < number.low < number.start < number.high < 1e5
        if number.null is not None:
            assert number.low <= number.null <= number.high
            assert number.null != number.start
        if number.unit == "1":
            assert not name.endswith(("_s", "_m", "_V", "_A", "_rad"))
        else:
            assert name.endswith(UNITS[number.unit])
    assert any(number.null is not None for number in effect.parameters().values())


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_a_multiplicative_parameter_is_1_without_effect_and_any_other_0(effect):
    for name, number in effect.parameters().items():
        if number.null is not None and name not in {"limit_A", "saturation_m", "high"}:
            assert number.null == (1.0 if name in {"scale", "gain", "height_scale"} else 0.0)


@pytest.mark.parametrize(("effect", "choices"), CASES)
def test_a_effect_survives_dictionary_and_json(effect, choices, excitable):
    robot = excitable.with_effect(effect.start(choices))
    plain = robot.model_dump()
    assert plain["effects"] == {effect.name: {**{n: p.start for n, p in effect.parameters().items()}, **choices}}
    assert RobotConfig.model_validate(plain) == robot
    assert RobotConfig.model_validate_json(robot.model_dump_json()) == robot
    assert RobotModel.from_config(excitable).with_effect(effect.start(choices)) == RobotModel.from_config(robot)


def test_a_robot_without_effects_has_no_key_for_any(excitable):
    assert excitable.model_dump()["effects"] == {}


@pytest.mark.parametrize(("effect", "choices"), CASES)
def test_every_parameter_is_a_config_key_and_an_axis_of_randomisation(effect, choices):
    ends = {
        name: sorted((number.start, 0.5 * (number.start + (number.high if number.null is None else number.null))))
        for name, number in effect.parameters().items()
    }
    settings = [f"robot.effects.{effect.name}.{name}={choice}" for name, choice in choices.items()]
    settings += [f"robot.effects.{effect.name}.{name}={{uniform: {list(pair)}}}" for name, pair in ends.items()]
    section = load_section("robot", "nominal", settings)
    one, drawn = draw_robot(section, 1, "a", 1)
    other, _ = draw_robot(section, 1, "a", 2)
    assert set(drawn) == {f"robot.effects.{effect.name}.{name}" for name in ends}
    for name, (low, high) in ends.items():
        assert low <= getattr(one.effects.get(effect), name) <= high
        assert getattr(one.effects.get(effect), name) != getattr(other.effects.get(effect), name)


@pytest.mark.parametrize(("effect", "choices"), CASES)
class TestInTwinAndBench:
    def test_the_null_value_is_bit_identical_to_no_effect(
        self, effect, choices, excitable, read_in_twin, bare_in_twin, read_on_bench, bare_on_bench
    ):
        robot = excitable.with_effect(effect.null(choices))
        assert read_in_twin(robot) == bare_in_twin
        assert read_on_bench(robot) == bare_on_bench

    def test_the_start_value_changes_a_reading(
        self, effect, choices, excitable, read_in_twin, bare_in_twin, read_on_bench, bare_on_bench
    ):
        robot = excitable.with_effect(effect.start(choices))
        changed_on_bench = read_on_bench(robot) != bare_on_bench
        if effect.slot is Slot.GEARBOX:
            assert changed_on_bench
            with pytest.raises(InputError, match=r"gap_rad: .*the twin.* motor bench alone"):
                read_in_twin(robot)
        else:
            assert changed_on_bench or read_in_twin(robot) != bare_in_twin


@pytest.mark.parametrize(("effect", "choices"), CASES)
class TestInTheEngine:
    def test_the_null_value_is_bit_identical_to_no_effect(
        self, effect, choices, excitable, read_in_engine, bare_in_engine
    ):
        assert read_in_engine(excitable.with_effect(effect.null(choices))) == bare_in_engine

    def test_the_start_value_changes_a_reading(self, effect, choices, excitable, read_in_engine, bare_in_engine):
        robot = excitable.with_effect(effect.start(choices))
        if effect.slot is Slot.GEARBOX:
            with pytest.raises(InputError, match=r"gap_rad: .*PyBullet.* motor bench alone"):
                read_in_engine(robot)
        else:
            assert read_in_engine(robot) != bare_in_engine


@pytest.fixture(scope="module")
def bare_in_twin(excitable, read_in_twin):
    return read_in_twin(excitable)


@pytest.fixture(scope="module")
def bare_on_bench(excitable, read_on_bench):
    return read_on_bench(excitable)


@pytest.fixture(scope="module")
def bare_in_engine(excitable, read_in_engine):
    return read_in_engine(excitable)


def test_the_order_in_a_file_does_not_matter(tmp_path, read_in_twin, read_on_bench):
    first = {name: next(iter(effect.options().values()), ()) for name, effect in BY_NAME.items()}
    effects = {
        name: effect.start({key: CHOICES.get(key, first[name])[0] for key in effect.options()}).model_dump()
        for name, effect in BY_NAME.items()
    }
    found = []
    for order in (list(effects), list(reversed(effects))):
        path = tmp_path / "robot.yaml"
        text = {
            "extends": "nominal",
            "name": "all",
            "description": "",
            "effects": {name: effects[name] for name in order},
        }
        path.write_text(yaml.safe_dump(text, sort_keys=False))
        robot = RobotConfig.model_validate(load_section("robot", str(path)).tree)
        rigid = robot.with_effect(GearBacklash(gap_rad=0.0))
        found.append((robot.model_dump_json(), read_on_bench(robot), read_in_twin(rigid)))
    assert found[0] == found[1]


def test_every_effect_is_a_row_of_the_documentation():
    table = (ROOT / "docs/reference/effects.md").read_text()
    for effect in BY_NAME.values():
        rows = []
        for name, number in effect.parameters().items():
            null = "-" if number.null is None else f"{number.null:g}"
            rows.append(f"| {name} | {number.unit} | {null} | {number.start:g} | {number.low:g} ... {number.high:g} |")
        rows.append(f"{effect.cause[1:]}. Seen in: {effect.excitation}.")
        assert [row for row in rows if row not in table] == []
        assert f"## {effect.name}\n" in table
