"""The oracle of the hide-and-find cases, against closed forms; none of our own models is asked."""

import ast
import importlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

TESTS = Path(__file__).parents[1]
FOLDER = TESTS / "gap_cases"
OURS = {"configs", "physics", "sensors", "diagnosis", "blender_scenes", "pipeline"}

R, K, B, Tc, J = 3.0, 0.3, 0.002, 0.02, 0.003
DAMPING = B + K**2 / R
TAU_S = J / DAMPING
MOTOR = {
    "winding_resistance_ohm": R,
    "torque_constant_N_m_A": K,
    "viscous_friction_N_m_s_rad": B,
    "coulomb_friction_N_m": Tc,
    "rotor_inertia_kg_m2": J,
}


@pytest.fixture(scope="module", autouse=True)
def _cases_on_the_path():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(TESTS))
        yield


@pytest.fixture(scope="module")
def gap():
    return importlib.import_module("gap_cases")


@pytest.fixture(scope="module")
def part():
    return lambda name: importlib.import_module(f"gap_cases.{name}")


@pytest.fixture
def world(gap):
    """A robot with an effect or two, with round numbers."""
    return lambda *effects, own=MOTOR: gap.World(own, tuple(gap.Effect(name, numbers) for name, numbers in effects))


@pytest.fixture
def settle(part):
    """Current and speed at voltages, `after_s` since switching on."""

    def settled(robot, voltage, after_s=0.0):
        law = part("motor_law")
        voltage = np.array(voltage, dtype=float)
        found = law.steady_states(law.Motors.of([robot], 7.4), voltage, np.full_like(voltage, after_s))
        return found[0][0], found[1][0]

    return settled


@pytest.fixture
def respond(gap, part):
    """Current and speed at 200 Hz for levels of voltage, each with the time from which it is held."""

    def responded(robot, *levels, rows=400):
        kind = part("motor_step")
        bench = gap.draw_bench("motor_step", 1, "few")
        time = 0.005 * np.arange(1, rows + 1)
        voltage = np.zeros(rows)
        for begin_s, level in levels:
            voltage[time > begin_s + 1e-9] = level
        inputs = {"trial": np.ones(rows), "u_cmd_V": voltage, "session_time_s": time, "t_s": time}
        current, speed = kind.mean(bench, inputs, [robot])
        return time, current[0], speed[0]

    return responded


def rising(time, voltage, tau_s=TAU_S):
    return (K * voltage / R - Tc) / DAMPING * (1.0 - np.exp(-time / tau_s))


def test_the_oracle_imports_nothing_that_it_judges():
    modules = sorted(FOLDER.glob("*.py"))
    assert len(modules) > 8
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                assert OURS.isdisjoint(alias.name.split(".")[0] for alias in node.names), path.name
            elif isinstance(node, ast.ImportFrom) and not node.level:
                assert (node.module or "").split(".")[0] not in OURS, path.name


def test_a_settled_motor_balances_its_torques(world, settle):
    current, speed = settle(world(), [5.0, -5.0])
    expected = (K * 5.0 / R - Tc) / DAMPING
    assert speed == pytest.approx([expected, -expected], rel=1e-9)
    assert current * K == pytest.approx([B * expected + Tc, -B * expected - Tc], rel=1e-9)


def test_a_motor_below_breakaway_is_stuck_with_the_current_of_its_winding(world, settle):
    breakaway = Tc * R / K
    current, speed = settle(world(), [0.99 * breakaway, -0.99 * breakaway, 1.01 * breakaway, 0.0])
    assert (speed == 0.0).tolist() == [True, True, False, True]
    assert current[[0, 1, 3]] == pytest.approx([0.99 * Tc / K, -0.99 * Tc / K, 0.0])


SAGGED = R + 2.0 * (4.0 / 7.4) ** 2


@pytest.mark.parametrize(
    ("name", "parameters", "speed_rad_s"),
    [
        ("bridge_voltage_drop", {"drop_V": 0.5}, (K * 3.5 / R - Tc) / DAMPING),
        ("friction_asymmetry", {"asymmetry": 0.2}, (K * 4.0 / R - 0.8 * Tc) / DAMPING),
        ("coulomb_friction_scale", {"scale": 1.5}, (K * 4.0 / R - 1.5 * Tc) / DAMPING),
        ("supply_sag", {"source_resistance_ohm": 2.0}, (K * 4.0 / SAGGED - Tc) / (B + K**2 / SAGGED)),
        ("friction_warmup", {"amplitude": 0.5, "time_constant_s": 60.0}, (K * 4.0 / R - 1.25 * Tc) / DAMPING),
    ],
)
def test_a_settled_motor_with_an_effect(world, settle, name, parameters, speed_rad_s):
    """After 60 ln 2 seconds half of a warm-up is left."""
    _, speed = settle(world((name, parameters)), [4.0], after_s=60.0 * np.log(2.0))
    assert speed == pytest.approx([speed_rad_s], rel=1e-9)


def test_quadratic_drag_is_the_root_of_its_square_equation(world, settle):
    _, speed = settle(world(("quadratic_drag", {"coefficient_N_m_s2_rad2": 4e-4})), [-5.0])
    torque = K * 5.0 / R - Tc
    assert speed == pytest.approx([-(np.sqrt(DAMPING**2 + 4 * 4e-4 * torque) - DAMPING) / (2 * 4e-4)], rel=1e-9)


def test_stribeck_friction_holds_a_motor_that_coulomb_friction_would_not(world, settle):
    """Breakaway at Tc + extra; far beyond its speed nothing of it is left."""
    robot = world(("stribeck_friction", {"extra_torque_N_m": 0.01, "stribeck_speed_rad_s": 0.5}))
    breakaway = (Tc + 0.01) * R / K
    _, speed = settle(robot, [0.99 * breakaway, 1.01 * breakaway, 5.0])
    assert (speed > 0.0).tolist() == [False, True, True]
    assert speed[2] == pytest.approx((K * 5.0 / R - Tc) / DAMPING, rel=1e-9)


def test_a_step_of_voltage_is_an_exponential(world, respond):
    time, current, speed = respond(world(), (0.0, 4.0))
    assert speed == pytest.approx(rising(time, 4.0), abs=1e-4)
    assert current == pytest.approx((4.0 - K * rising(time, 4.0)) / R, abs=1e-4)


def test_a_short_circuit_stops_the_motor_in_finite_time(world, respond):
    """w = (w0 + c) exp(-t / tau) - c with c = Tc / (B + K^2 / R), until it is 0."""
    time, current, speed = respond(world(), (0.0, 4.0), (1.0, 0.0))
    first, offset = rising(1.0, 4.0), Tc / DAMPING
    braked = np.maximum((first + offset) * np.exp(-(time - 1.0) / TAU_S) - offset, 0.0)
    assert speed[200:] == pytest.approx(braked[200:], abs=2e-3)
    assert (speed[-100:] == 0.0).all()
    assert (current[-100:] == 0.0).all()


def test_a_reversal_goes_through_zero_without_a_rest(world, respond):
    """After the moment of rest, an exponential from there, with friction the other way."""
    time, _, speed = respond(world(), (0.0, 3.0), (1.0, -3.0))
    first, towards = rising(1.0, 3.0), (K * 3.0 / R + Tc) / DAMPING
    zero_s = 1.0 + TAU_S * np.log((first + towards) / towards)
    after = time > zero_s
    assert speed[after] == pytest.approx(-rising(time[after] - zero_s, 3.0), abs=5e-3)


def test_a_stuck_motor_stays_stuck_below_breakaway(world, respond):
    _, current, speed = respond(world(), (0.0, 0.99 * Tc * R / K))
    assert (speed == 0.0).all()
    assert current == pytest.approx(0.99 * Tc / K)


def test_delays_shift_and_lags_round(world, respond):
    time, current, speed = respond(world(("input_delay", {"delay_s": 0.007})), (0.0, 4.0))
    later = np.maximum(time - 0.007, 0.0)
    assert speed == pytest.approx(rising(later, 4.0), abs=2e-3)
    assert current[0] == 0.0
    speed = respond(world(("speed_time_offset", {"delay_s": 0.013})), (0.0, 4.0))[2]
    assert speed == pytest.approx(rising(np.maximum(time - 0.013, 0.0), 4.0), abs=2e-3)
    lag = 0.02
    speed = respond(world(("speed_filter_lag", {"time_constant_s": lag})), (0.0, 4.0))[2]
    both = (TAU_S * np.exp(-time / TAU_S) - lag * np.exp(-time / lag)) / (TAU_S - lag)
    assert speed == pytest.approx((K * 4.0 / R - Tc) / DAMPING * (1.0 - both), abs=2e-3)


def test_a_lagging_actuator_starts_when_it_overcomes_friction(world, respond):
    """u = 4 (1 - exp(-t / T)) breaks away at t0; the linear equation from there has this solution."""
    lag = 0.03
    time, _, speed = respond(world(("actuator_lag", {"time_constant_s": lag})), (0.0, 4.0))
    begin = -lag * np.log(1.0 - Tc * R / K / 4.0)
    t = np.maximum(time - begin, 0.0)
    final = (K * 4.0 / R - Tc) / DAMPING
    pulled = K * 4.0 / R / DAMPING * np.exp(-begin / lag) / (1.0 - TAU_S / lag)
    expected = final - pulled * np.exp(-t / lag) - (final - pulled) * np.exp(-t / TAU_S)
    assert speed == pytest.approx(expected, abs=0.01)


def test_a_limited_current_accelerates_evenly(world, respond):
    current, speed = respond(world(("current_limit", {"limit_A": 0.5})), (0.0, 5.0))[1:]
    assert current[:10] == pytest.approx(0.5)
    torque = K * 0.5 - Tc
    assert speed[9] == pytest.approx(torque / B * (1.0 - np.exp(-0.05 * B / J)), rel=1e-3)


def test_play_lets_the_motor_run_alone_until_the_sides_meet(world, respond):
    """Half the gap with its own inertia and friction; then the speed is shared, as of a blow that does not bounce."""
    gap_rad, inertia, friction = 0.3, 0.6 * J, 0.5
    damping = friction * B + K**2 / R
    final, tau_s = (K * 4.0 / R - friction * Tc) / damping, inertia / damping
    time, _, speed = respond(world(("gear_backlash", {"gap_rad": gap_rad})), (0.0, 4.0), rows=60)
    angle = final * (time - tau_s * (1.0 - np.exp(-time / tau_s)))
    free = angle < 0.5 * gap_rad
    assert 3 < free.sum() < 30
    assert speed[free] == pytest.approx(final * (1.0 - np.exp(-time[free] / tau_s)), abs=0.02)
    fine = np.linspace(0.0, 0.2, 200_001)
    meet = fine[np.searchsorted(final * (fine - tau_s * (1.0 - np.exp(-fine / tau_s))), 0.5 * gap_rad)]
    shared = 0.6 * final * (1.0 - np.exp(-meet / tau_s))
    settled = (K * 4.0 / R - Tc) / DAMPING
    after = time > meet
    expected = settled + (shared - settled) * np.exp(-(time[after] - meet) / TAU_S)
    assert speed[after] == pytest.approx(expected, abs=0.02)


def test_next_to_no_play_is_one_mass(world, respond):
    steps = (0.0, 3.0), (0.25, 0.0), (0.45, -4.0), (0.7, 2.0)
    speed = respond(world(("gear_backlash", {"gap_rad": 1e-6})), *steps, rows=180)[2]
    assert speed == pytest.approx(respond(world(), *steps, rows=180)[2], abs=0.03)


TOF = {"range_offset_m": 0.001, "range_scale": 1.01}
ROWS = {
    "distance_m": np.array([0.18, 0.36, 0.9]),
    "t_s": np.array([0.0, 60.0, 120.0]),
    "material": np.array(["wood", "black_card", "wood"]),
    "incidence_rad": np.array([0.0, np.pi / 6, 0.0]),
    "temperature_C": np.array([25.0, 35.0, 15.0]),
    "ambient_lux": np.array([0.0, 1000.0, 3000.0]),
}


@pytest.mark.parametrize(
    ("name", "parameters", "added_m"),
    [
        ("log_range_error", {"coefficient_m": 0.01}, [0.0, 0.01 * np.log(2), 0.01 * np.log(5)]),
        ("temperature_drift", {"coefficient_m_per_K": 1e-3}, [0.0, 0.01, -0.01]),
        ("material_bias", {"material": "black_card", "offset_m": 0.004}, [0.0, 0.004, 0.0]),
        ("incidence_bias", {"coefficient": 0.1}, [0.0, 0.1 * 0.36 / 4, 0.0]),
        ("near_field_error", {"amplitude_m": 0.01, "decay_length_m": 0.18}, 0.01 * np.exp([-1.0, -2.0, -5.0])),
        ("warmup_drift", {"amplitude_m": 0.01, "time_constant_s": 60.0}, 0.01 * np.exp([0.0, -1.0, -2.0])),
        ("range_offset", {"offset_m": -0.01}, [-0.01, -0.01, -0.01]),
        ("range_saturation", {"saturation_m": 0.5}, [0.0, 0.0, 0.5 - 1.01 * 0.9 - 0.001]),
    ],
)
def test_a_range_reading_with_an_effect(part, world, name, parameters, added_m):
    found = part("tof_bench").mean(ROWS, [world(own=TOF), world((name, parameters), own=TOF)])
    assert found[0] == pytest.approx(1.01 * ROWS["distance_m"] + 0.001)
    assert found[1] - found[0] == pytest.approx(np.array(added_m), abs=1e-12)


def test_crosstalk_shortens_far_and_dark_targets(part, world):
    robot = world(("cover_crosstalk", {"strength_per_m2": 0.02}), own={"range_offset_m": 0.0, "range_scale": 1.0})
    d = ROWS["distance_m"]
    expected = d / (1.0 + 0.02 * d**2 / np.array([0.45, 0.05, 0.45]))
    assert part("tof_bench").mean(ROWS, [robot])[0] == pytest.approx(expected)


def test_the_noise_of_ranges_is_the_polynomial_times_its_effects(part, world):
    nominal = 1e-3 * np.array([1.4, 1.4 + 4.88 * 0.18 + 2.51 * 0.18**2 + 1.15 * 0.18**3])
    robots = [world(own=TOF), world(("noise_scale", {"scale": 2.0}), own=TOF)]
    robots.append(world(("ambient_noise", {"coefficient_per_klux": 3.0}), own=TOF))
    found = part("tof_bench").sd(ROWS, robots)
    assert found[0, :2] == pytest.approx(nominal)
    assert found[1] == pytest.approx(2.0 * found[0])
    assert found[2] == pytest.approx(found[0] * np.sqrt([1.0, 4.0, 10.0]))


def test_noise_has_the_spread_and_the_correlation_it_should(part):
    noise = part("noise").correlated(np.random.default_rng(0), (200, 500), 0.3)
    assert noise.std() == pytest.approx(1.0, abs=0.01)
    assert np.mean(noise[:, 1:] * noise[:, :-1]) == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize("kind", ["motor_steady", "tof_bench"])
def test_a_case_without_effects_has_residuals_of_its_noise(gap, part, kind):
    """Bad readings are at most 2 of 100, so that all but a few are within three sigmas of the true robot."""
    shares = []
    for seed in range(20):
        case = gap.make_case(kind, seed)
        frame = part(kind).frame(case.bench, case.columns)
        z = (frame.measured - part(kind).predict(case.bench, case.columns, [case.world])[0]) / frame.sigma
        shares.append(np.mean(np.abs(z[np.isfinite(z)]) > 3.0))
    assert 0.0 < np.mean(shares) < 0.025


def test_the_same_seed_is_the_same_case(gap, tmp_path):
    for name, seed in (("a", 5), ("b", 5), ("c", 6)):
        gap.write(gap.make_case("motor_steady", seed, [("supply_sag", None)]), tmp_path / name)
    texts = {name: (tmp_path / name / "data.csv").read_text() for name in "abc"}
    assert texts["a"] == texts["b"] != texts["c"]


def test_what_is_written_does_not_tell_what_is_hidden(gap, tmp_path):
    gap.write(gap.make_case("tof_bench", 3, [("warmup_drift", None)], rows="few"), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["blind_inputs.csv", "data.csv", "nominal.yaml"]
    assert not any("warmup" in path.read_text() for path in tmp_path.iterdir())
    assert yaml.safe_load((tmp_path / "nominal.yaml").read_text())["kind"] == "tof_bench"
    lines = (tmp_path / "data.csv").read_text().splitlines()
    assert lines[0] == "row,split,t_s,distance_m,material,incidence_rad,temperature_C,ambient_lux,reading_m"
    assert len(lines) == 61


@pytest.mark.parametrize(("kind", "rows", "count"), [("motor_steady", "usual", 168), ("motor_steady", "few", 21)])
def test_cases_have_the_rows_of_the_format(gap, kind, rows, count):
    case = gap.make_case(kind, 1, rows=rows)
    assert len(case.columns["row"]) == count
    assert 0.1 < np.mean(case.columns["split"] == "holdout") < 0.4


def test_every_effect_can_be_drawn_and_says_something_new(gap):
    """None is at its neutral value, and words are of those that the data have."""
    for kind in gap.KINDS:
        bench = gap.draw_bench(kind, 2)
        for name in gap.SIZES[kind]:
            drawn = [gap.draw_effect(name, bench, seed) for seed in range(6)]
            assert len({tuple(each.parameters.values()) for each in drawn}) == 6, name
            for each in drawn:
                numbers = {k: v for k, v in each.parameters.items() if not isinstance(v, str)}
                neutral = all(v == (1.0 if k in {"scale", "gain"} else 0.0) for k, v in numbers.items())
                assert not neutral, name


def test_the_expected_drop_is_the_generalised_distance(gap, part):
    """d' (S + J T^2 J')^-1 d, with the nuisances as one more part of the noise (Woodbury's identity)."""
    case = gap.make_case("tof_bench", 4, [("incidence_bias", {"coefficient": 0.04})])
    kind, columns = part("tof_bench"), case.columns
    reading = columns["reading_m"]
    rows = (columns["split"] == "fit") & np.isfinite(reading) & (reading < 8.0)
    sigma = kind.sd(columns, [case.bench.textbook()])[0][rows]
    distance, tilt = columns["distance_m"][rows], np.sin(columns["incidence_rad"][rows]) ** 2
    J = np.stack([np.full_like(distance, 0.0005), 0.002 * distance], axis=1)
    shape = 0.04 * distance * tilt
    expected = shape @ np.linalg.solve(np.diag(sigma**2) + J @ J.T, shape)
    assert gap.judge(case, 0).drops == pytest.approx((expected,), rel=1e-3)


def test_names_that_the_data_cannot_tell_apart_are_equivalent(gap):
    """One material: its bias is an offset. One level of light: its noise is a scale."""
    offset = gap.judge(gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})], rows="few"))
    assert offset.equivalent == (("material_bias[white_paper]",),)
    noise = gap.judge(gap.make_case("tof_bench", 1, [("noise_scale", {"scale": 2.5})], rows="few"))
    assert noise.equivalent == (("ambient_noise",),)
    several = gap.judge(gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})]))
    assert several.equivalent == ((),)


def test_an_effect_within_the_tolerance_is_not_detectable(gap):
    def drop(scale):
        return gap.judge(gap.make_case("motor_steady", 1, [("winding_resistance_scale", {"scale": scale})]), 0).drops[0]

    assert drop(1.01) < 1.5
    assert drop(1.15) > gap.DETECTABLE


def test_what_no_name_can_take_is_nameless(gap):
    verdict = gap.judge(gap.make_case("tof_bench", 2, outside="memory"))
    assert gap.DETECTABLE < verdict.nameless < verdict.beyond
    assert verdict.drops == ()


def test_the_error_leaves_out_the_largest_of_a_hundred_by_three(gap, part):
    case = gap.make_case("tof_bench", 1)
    frame = part("tof_bench").frame(case.bench, case.columns)
    z = np.concatenate([np.full(97, 2.0), [50.0, -60.0, 70.0], np.full(100, 9.0)])
    zeros = np.zeros(200, dtype=int)
    holdout = np.arange(200) < 100
    frame = replace(frame, measured=z, sigma=np.ones(200), holdout=holdout, stage=zeros, run=zeros)
    assert part("judge").error(frame, np.zeros(200)) == pytest.approx(2.0)
