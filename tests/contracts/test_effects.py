"""What holds for every effect, of physics and of sensors alike."""

from pathlib import Path

import pytest
import yaml

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from physics.robot.model import RobotModel
from pipeline.effects.contract import RULES, judged
from pipeline.effects.probe import Probe, equal
from pipeline.effects.trial import ANY_NAME, trials
from symolo.core.errors import InputError
from symolo.core.field_descriptions import field_descriptions

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
    "random_slip": "slip_m_sqrt_m, length_m",
    "floor_slope": "gradient, direction_rad, on_the_spot",
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

UNITS = {"N m": "N_m", "rad/s": "rad_s", "N m s2/rad2": "N_m_s2_rad2", "V": "V", "ohm": "ohm", "1/min": "per_minute"}
UNITS |= {"s": "s", "A": "A", "rad": "rad", "m": "m", "m/K": "m_per_K", "1/m2": "per_m2", "1/klux": "per_klux"}
UNITS |= {"s2/m": "s2_m", "m/sqrt(m)": "m_sqrt_m", "m/rad": "m_per_rad", "H": "H", "Hz": "Hz"}
PROBE = Probe()


def is_between(trial):
    """Whether a parameter that is no number has neither its first nor its last choice: one channel of eight."""
    options = trial.effect.options()
    return any(
        options[name] and choice not in options[name][:1] + options[name][-1:] for name, choice in trial.choices.items()
    )


CASES = [
    pytest.param(trial, id=trial.name, marks=pytest.mark.long if is_between(trial) else ())
    for effect in BY_NAME.values()
    for trial in trials(effect, PROBE)
]


def test_the_effects_are_those_of_the_shared_format():
    assert {name: ", ".join(effect.model_fields) for name, effect in BY_NAME.items()} == CANONICAL
    assert len(BY_NAME) == len(EFFECTS.classes())


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_an_effect_has_a_file_of_its_name(effect):
    assert effect.__module__.rsplit(".", 1)[1] == effect.name


@pytest.mark.parametrize("trial", CASES)
def test_it_keeps_every_rule(trial):
    rules = [rule for rule in RULES if rule.name != "distinct"]
    assert [f"{v.rule.name}: {v.problem}" for v in judged(trial, rules) if v.problem] == []


@pytest.mark.long
@pytest.mark.parametrize("trial", CASES)
def test_no_other_effect_of_its_slot_does_the_same(trial):
    (distinct,) = judged(trial, [rule for rule in RULES if rule.name == "distinct"])
    assert distinct.problem == ""


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_a_multiplicative_parameter_is_1_without_effect_and_any_other_0(effect):
    for name, number in effect.parameters().items():
        if number.null is not None and name not in {"limit_A", "saturation_m", "high"}:
            assert number.null == (1.0 if name in {"scale", "gain", "height_scale"} else 0.0)


@pytest.mark.parametrize("effect", BY_NAME.values(), ids=lambda effect: effect.name)
def test_the_name_of_a_number_ends_in_its_unit(effect):
    for name, number in effect.parameters().items():
        assert number.unit == "1" or name.endswith(UNITS[number.unit])


@pytest.mark.parametrize("effect", EFFECTS.classes(), ids=lambda effect: effect.name)
def test_an_effect_and_each_of_its_fields_have_a_description(effect):
    assert effect.__doc__
    assert set(field_descriptions(effect)) == set(effect.model_fields)


def test_a_robot_without_effects_has_no_key_for_any():
    assert PROBE.robot.model_dump()["effects"] == {}


@pytest.mark.parametrize("trial", CASES)
def test_it_survives_the_model_of_the_robot(trial):
    robot = PROBE.robot.with_effect(trial.start)
    assert RobotModel.from_config(PROBE.robot).with_effect(trial.start) == RobotModel.from_config(robot)


@pytest.mark.parametrize("trial", CASES)
def test_every_parameter_is_a_config_key_and_an_axis_of_randomisation(trial):
    effect = trial.effect
    ends = {
        name: sorted((number.start, 0.5 * (number.start + (number.high if number.null is None else number.null))))
        for name, number in effect.parameters().items()
    }
    settings = [f"robot.effects.{effect.name}.{name}={choice}" for name, choice in trial.choices.items()]
    settings += [f"robot.effects.{effect.name}.{name}={{uniform: {list(pair)}}}" for name, pair in ends.items()]
    section = load_section("robot", "nominal", settings)
    one, drawn = draw_robot(section, 1, "a", 1)
    other, _ = draw_robot(section, 1, "a", 2)
    assert set(drawn) == {f"robot.effects.{effect.name}.{name}" for name in ends}
    for name, (low, high) in ends.items():
        assert low <= getattr(one.effects.get(effect), name) <= high
        assert getattr(one.effects.get(effect), name) != getattr(other.effects.get(effect), name)


def test_play_in_a_gear_is_refused_by_every_drive():
    robot = PROBE.robot.with_effect(GearBacklash(gap_rad=0.05))
    with pytest.raises(InputError, match=r"gap_rad: .*the twin.* motor bench alone"):
        PROBE.in_twin(robot)
    with pytest.raises(InputError, match=r"gap_rad: .*PyBullet.* motor bench alone"):
        PROBE.in_engine(robot)
    robot = PROBE.robot.with_effect(GearBacklash.null())
    assert equal(PROBE.in_twin(robot), PROBE.in_twin(PROBE.robot))
    assert equal(PROBE.in_engine(robot), PROBE.in_engine(PROBE.robot))


def test_the_order_in_a_file_does_not_matter(tmp_path):
    first = {name: next(iter(effect.options().values()), ()) for name, effect in BY_NAME.items()}
    effects = {
        name: effect.start({key: ANY_NAME.get(key, first[name])[0] for key in effect.options()}).model_dump()
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
        found.append((robot.model_dump_json(), PROBE.on_bench(robot), PROBE.in_twin(rigid)))
    (text, on_bench, in_twin), (other_text, *others) = found
    assert text == other_text
    assert [equal(*pair) for pair in zip((on_bench, in_twin), others, strict=True)] == [True, True]


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
