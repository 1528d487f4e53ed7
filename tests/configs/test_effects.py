"""Effects in files: names, bounds, what is inherited, and what the simulation refuses."""

import json
import math

import numpy as np
import pytest

from configs.draw import draw_robot, draw_run
from configs.loader import load_scenario, load_section
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.motor_and_gearbox.coulomb_friction_scale import CoulombFrictionScale
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.effects.motor_and_gearbox.viscous_friction_scale import ViscousFrictionScale
from physics.effects.motor_and_gearbox.winding_resistance_scale import WindingResistanceScale
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from sensors.effects.pose_log.marker_offset import MarkerOffset
from symolo.core.distributions import Normal
from symolo.core.errors import InputError
from symolo.core.random_streams import stream


def test_a_effect_that_does_not_exist_is_refused_with_the_nearest():
    with pytest.raises(InputError, match=r"robot\.effects\.suply_sag: unknown key.*did you mean supply_sag"):
        load_scenario("smoke", ["robot.effects.suply_sag.source_resistance_ohm=0.3"])


def test_a_value_beyond_its_bounds_is_refused():
    with pytest.raises(InputError, match=r"source_resistance_ohm: got -0\.1, allowed: number >= 0\.0 and <= 20\.0"):
        load_scenario("smoke", ["robot.effects.supply_sag.source_resistance_ohm=-0.1"])


def test_a_effect_must_be_whole():
    with pytest.raises(InputError, match=r"robot\.effects\.stribeck_friction\.stribeck_speed_rad_s: missing"):
        load_scenario("smoke", ["robot.effects.stribeck_friction.extra_torque_N_m=0.01"])


def test_an_inherited_effect_is_taken_away_by_null():
    robot, _ = draw_robot(load_section("robot", "worn", ["robot.effects.supply_sag=null"]), 1)
    assert robot.effects.get(SupplySag) is None
    assert robot.effects.get(InputDelay) is not None
    assert "supply_sag" not in robot.model_dump()["effects"]


def test_a_effect_of_a_scenario_is_added_to_those_of_its_robot():
    spec = draw_run(load_scenario("smoke", ["robot=worn", "robot.effects.marker_offset.offset_m=0.02"]), "CW", 1)
    assert spec.robot.effects.get(MarkerOffset) is not None
    assert spec.robot.effects.get(WheelbaseScale) is not None


def test_backlash_is_refused_for_a_simulation_and_taken_for_a_robot():
    setting = "robot.effects.gear_backlash.gap_rad=0.02"
    with pytest.raises(InputError, match=r"gear_backlash\.gap_rad: PyBullet's wheel is one mass.*motor bench alone"):
        load_scenario("smoke", [setting])
    with pytest.raises(InputError, match="one mass"):
        load_scenario("smoke", [setting.replace("0.02", "{uniform: [0, 0.02]}")])
    load_scenario("smoke", [setting.replace("0.02", "0")])
    load_section("robot", "nominal", [setting])


def test_a_material_that_no_wall_can_have_is_refused():
    with pytest.raises(InputError, match=r"material: no such surface: got 'black_bord'.*did you mean black_board"):
        load_section("robot", "nominal", ["robot.effects.material_bias={material: black_bord, offset_m: 0.01}"])


def test_the_fleet_spreads_as_real_fleets_do():
    """Resistance 11 %, gain 7 %, friction 40 %; with the inertia alike the first two make the time constant's 18 %."""
    section = load_section("robot", "fleet")
    found = []
    for number in range(600):
        effects = draw_robot(section, 1, number)[0].effects
        resistance, constant = effects.get(WindingResistanceScale).scale, effects.get(TorqueConstantScale).scale
        frictions = (effects.get(CoulombFrictionScale).scale, effects.get(ViscousFrictionScale).scale)
        found.append((resistance, 1.0 / constant, *frictions, resistance / constant**2))
    spread = np.std(found, axis=0) / np.mean(found, axis=0)
    assert spread == pytest.approx([0.11, 0.07, 0.40, 0.40, math.hypot(0.11, 2 * 0.07)], rel=0.08)
    assert np.mean(found, axis=0) == pytest.approx(1.0, abs=0.05)


def test_a_worn_robot_has_several_effects_and_differs_in_nothing_else():
    worn, nominal = (draw_robot(load_section("robot", name), 1)[0] for name in ("worn", "nominal"))
    assert len(worn.effects.members) > 10
    kept = {"name", "description", "effects"}
    assert worn.model_dump(exclude=kept) == nominal.model_dump(exclude=kept)


def test_a_seed_draws_the_numbers_of_an_effect_that_it_drew_before_terms_were_renamed():
    robot, drawn = draw_robot(load_section("robot", "fleet"), 7, "CW", 2)
    before = stream(7, "CW", 2, "robot.terms.winding_resistance_scale.scale")
    expected = Normal(1.0, 0.1175, 0.725, 1.275).draw(before)
    assert robot.effects.get(WindingResistanceScale).scale == expected
    assert drawn["robot.effects.winding_resistance_scale.scale"] == expected


def test_a_saturation_whose_ends_are_the_wrong_way_round_is_refused():
    ends = ["robot.effects.line_adc_saturation.low=0.5", "robot.effects.line_adc_saturation.high=0.3"]
    with pytest.raises(InputError, match=r"robot\.effects\.line_adc_saturation\.low.*less than high, which is 0\.3"):
        load_scenario("smoke", ends)
    load_scenario("smoke", [ends[1], "robot.effects.line_adc_saturation.low=0.2"])


def test_the_creep_on_the_spot_is_written_only_if_it_differs_from_that_on_a_line():
    slope = FloorSlope(gradient=0.02, direction_rad=1.0)
    assert json.loads(slope.model_dump_json()) == {"gradient": 0.02, "direction_rad": 1.0}
    half = slope.model_copy(update={"on_the_spot": 0.5})
    assert FloorSlope.model_validate_json(half.model_dump_json()) == half
