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
OURS = {"configs", "logs", "physics", "sensors", "diagnosis", "blender_scenes", "pipeline"}

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
pytestmark = pytest.mark.usefixtures("cases_on_the_path")


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
        states = law.steady_states(law.Motors.from_worlds([robot], 7.4), voltage, np.full_like(voltage, after_s))
        return states[0][0], states[1][0]

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


@pytest.mark.parametrize(
    ("inductance_H", "driving_V", "lost_V_s"),
    [(1e-8, 6.0, K * 6.0 / 7.4), (10.0, 7.4 * (2.0 * 6.0 / 7.4 - 1.0) - 1.5 * (1.0 - 6.0 / 7.4), K)],
)
def test_a_bridge_that_coasts_between_its_limits(world, settle, inductance_H, driving_V, lost_V_s):
    """With little inductance the supply drives for a share of the time; with much, the current never stops."""
    effect = ("bridge_coast", {"inductance_H": inductance_H, "diode_V": 1.5, "switching_Hz": 20_000.0})
    _, speed = settle(world(effect), [6.0, -6.0])
    expected = (K * driving_V / R - Tc) / (B + K * lost_V_s / R)
    assert speed == pytest.approx([expected, -expected], rel=1e-3)


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


@pytest.mark.parametrize("play", [0.0, 1e-9])
@pytest.mark.parametrize("cycles", [1.0, 9.0])
def test_a_small_ripple_is_an_oscillation_of_the_settled_motor(world, respond, cycles, play):
    """Of amplitude A / |D + i J n w| about the settled speed w, behind the torque against it by the angle of that."""
    effects = [("torque_ripple", {"amplitude_N_m": 1e-3, "cycles_per_turn": cycles, "phase_rad": 0.5})]
    effects += [("gear_backlash", {"gap_rad": play})] if play else []
    time, _, speed = respond(world(*effects), (0.0, 3.0), rows=400)
    settled = time > 1.0
    mean = (K * 3.0 / R - Tc) / DAMPING
    angle = (np.cumsum(speed) - 0.5 * speed) * 0.005
    expected = (1e-3 / (DAMPING + 1j * J * cycles * mean) * np.exp(1j * (cycles * angle + 0.5))).real
    size = np.sqrt(np.mean(expected[settled] ** 2))
    assert np.sqrt(np.mean((speed - mean + expected)[settled] ** 2)) < 0.1 * size


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_ripple_holds_a_motor_in_one_direction_and_helps_it_in_the_other(world, respond, sign):
    ripple = ("torque_ripple", {"amplitude_N_m": 0.01, "cycles_per_turn": 5.0, "phase_rad": 0.0})
    breakaway = R / K * (Tc + sign * 0.01)
    for share, moves in ((0.98, False), (1.02, True)):
        _, _, speed = respond(world(ripple), (0.0, sign * share * breakaway), rows=4)
        assert bool((speed != 0.0).any()) == moves


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
        ("material_slope", {"material": "wood", "coefficient": 0.05}, [0.004, 0.0, 0.04]),
        ("tilt_asymmetry", {"axis": "forward", "coefficient_m_per_rad": 0.06}, [0.0, 0.01 * np.pi, 0.0]),
        ("incidence_bias", {"coefficient": 0.1}, [0.0, 0.1 * 0.36 / 4, 0.0]),
        ("near_field_error", {"amplitude_m": 0.01, "decay_length_m": 0.18}, 0.01 * np.exp([-1.0, -2.0, -5.0])),
        ("warmup_drift", {"amplitude_m": 0.01, "time_constant_s": 60.0}, 0.01 * np.exp([0.0, -1.0, -2.0])),
        ("range_offset", {"offset_m": -0.01}, [-0.01, -0.01, -0.01]),
        ("range_saturation", {"saturation_m": 0.5}, [0.0, 0.0, 0.5 - 1.01 * 0.9 - 0.001]),
    ],
)
def test_a_range_reading_with_an_effect(part, world, name, parameters, added_m):
    means = part("tof_bench").mean(ROWS, [world(own=TOF), world((name, parameters), own=TOF)])
    assert means[0] == pytest.approx(1.01 * ROWS["distance_m"] + 0.001)
    assert means[1] - means[0] == pytest.approx(np.array(added_m), abs=1e-12)


def test_crosstalk_shortens_far_and_dark_targets(part, world):
    robot = world(("cover_crosstalk", {"strength_per_m2": 0.02}), own={"range_offset_m": 0.0, "range_scale": 1.0})
    d = ROWS["distance_m"]
    expected = d / (1.0 + 0.02 * d**2 / np.array([0.45, 0.05, 0.45]))
    assert part("tof_bench").mean(ROWS, [robot])[0] == pytest.approx(expected)


def test_the_noise_of_ranges_is_the_polynomial_times_its_effects(part, world):
    nominal = 1e-3 * np.array([1.4, 1.4 + 4.88 * 0.18 + 2.51 * 0.18**2 + 1.15 * 0.18**3])
    robots = [world(own=TOF), world(("noise_scale", {"scale": 2.0}), own=TOF)]
    robots.append(world(("ambient_noise", {"coefficient_per_klux": 3.0}), own=TOF))
    sd = part("tof_bench").sd(ROWS, robots)
    assert sd[0, :2] == pytest.approx(nominal)
    assert sd[1] == pytest.approx(2.0 * sd[0])
    assert sd[2] == pytest.approx(sd[0] * np.sqrt([1.0, 4.0, 10.0]))


def test_a_wandering_error_forgets_as_an_exponential(part):
    """At 3 s and 10 s later, with a time constant of 10 s."""
    rng, times = np.random.default_rng(1), np.array([0.0, 3.0, 13.0])
    walks = np.array([part("tof_bench").wandering(rng, times, 10.0) for _ in range(3000)])
    expected = np.exp(-np.array([[0.0, 0.3, 1.3], [0.3, 0.0, 1.0], [1.3, 1.0, 0.0]]))
    assert walks.T @ walks / len(walks) == pytest.approx(expected, abs=0.08)


def test_the_drop_of_a_wandering_error_is_its_lead_in_likelihood(gap, part):
    """Over white noise of the best level, in the mean over many cases."""
    kind, expected, leads = part("tof_bench"), [], []
    hidden = [("range_wander", {"sd_m": 0.003, "time_constant_s": 30.0})]
    day = gap.Day(outliers=gap.Outliers({"reading_m": 0.0}, (5.0, 6.0), 0.0, 0.0, together=False))
    for seed in range(40):
        case = gap.make_case("tof_bench", seed, hidden, rows="some")
        columns, _ = kind.observe(case.true_bench, case.world, np.random.default_rng(seed), day)
        frame = kind.frame(case.bench, columns)
        error = frame.measured - kind.predict(case.bench, columns, [case.world])[0]
        rows = ~frame.holdout & np.isfinite(error)
        time, z = columns["t_s"][rows], (error / frame.sigma)[rows]
        slow = 0.003**2 * np.exp(-np.abs(np.subtract.outer(time, time)) / 30.0)
        true = np.eye(len(z)) + slow / np.outer(frame.sigma[rows], frame.sigma[rows])
        white = len(z) * (np.log(np.mean(z**2)) + 1.0)
        leads.append(white - np.linalg.slogdet(true)[1] - z @ np.linalg.solve(true, z))
        expected.append(gap.judge(replace(case, columns=columns), with_rivals=False).drops[0])
    assert np.mean(leads) == pytest.approx(np.mean(expected), rel=0.25)


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


def test_what_is_written_does_not_show_what_is_hidden(gap, tmp_path):
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
    assert gap.judge(case, with_rivals=False).drops == pytest.approx((expected,), rel=1e-3)


def test_names_that_the_data_cannot_distinguish_are_equivalent(gap):
    """One material: its bias is an offset. One level of light: its noise is a scale."""
    offset = gap.judge(gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})], rows="few"))
    assert offset.equivalent == (("material_bias[white_paper]",),)
    noise = gap.judge(gap.make_case("tof_bench", 1, [("noise_scale", {"scale": 2.5})], rows="few"))
    assert noise.equivalent == (("ambient_noise",),)
    several = gap.judge(gap.make_case("tof_bench", 1, [("range_offset", {"offset_m": 0.01})]))
    assert several.equivalent == ((),)


def test_an_effect_within_the_tolerance_is_not_detectable(gap):
    def drop(scale):
        return gap.judge(
            gap.make_case("motor_steady", 1, [("winding_resistance_scale", {"scale": scale})]), with_rivals=False
        ).drops[0]

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


RADIUS, WIDTH, TICKS, ROW_S = 0.03, 0.15, 1920, 0.05
ROBOT = {**MOTOR, "wheel_radius_m": RADIUS, "wheel_separation_m": WIDTH, "range_offset_m": 0.0}


@pytest.fixture
def volts(part):
    """Mean wheel speeds over rows (rows, 2) at voltages (2,) that are held from rest."""

    def driven(robot, voltage, begin_s=0.0, rows=20):
        wheels = part("drive_wheels")
        held = np.tile(np.array(voltage, dtype=float), (1, rows + 1, 1))
        speeds = wheels.mean_speeds(wheels.Wheels.from_worlds([robot], 7.4), held, np.array([begin_s]))
        return speeds[0, 0]

    return driven


def mean_rising(row, voltage, constant=K, resistance=R):
    """Over rows of 50 ms, of the exponential from rest."""
    damping = B + constant**2 / resistance
    tau = J / damping
    ends = tau * np.exp(-np.arange(row + 1) * ROW_S / tau)
    return (constant * voltage / resistance - Tc) / damping * (1.0 + np.diff(ends) / ROW_S)


@pytest.mark.parametrize(
    ("effect", "left", "right"),
    [
        ((), {}, {}),
        (("torque_constant_mismatch", {"mismatch": 0.1}), {"constant": 1.05 * K}, {"constant": 0.95 * K}),
        (("battery_decline", {"fraction_per_minute": 0.05}), {"voltage": 2.7}, {"voltage": 2.7}),
        (("supply_sag", {"source_resistance_ohm": 1.5}), *[{"resistance": R + 3.0 * (3.0 / 7.4) ** 2}] * 2),
    ],
    ids=["none", "mismatch", "decline", "sag"],
)
def test_wheels_follow_their_voltages_as_exponentials(world, volts, effect, left, right):
    """Two minutes into a session, a decline of 5 % per minute has taken a tenth; both currents load the supply."""
    robot = world(*([effect] if effect else []), own=ROBOT)
    speeds = volts(robot, (3.0, 3.0), begin_s=120.0)
    for side, expected in zip(speeds.T, (left, right), strict=True):
        assert side == pytest.approx(mean_rising(20, **{"voltage": 3.0} | expected), abs=0.007)


def test_a_delay_of_a_row_is_the_speed_of_the_row_before(world, volts):
    late = volts(world(("input_delay", {"delay_s": ROW_S}), own=ROBOT), (3.0, -3.0))
    assert late[1:] == pytest.approx(volts(world(own=ROBOT), (3.0, -3.0))[:-1], abs=1e-9)
    assert (late[0] == 0.0).all()


@pytest.fixture
def log(gap):
    """A bench and its columns: ticks per row of both wheels, and a pose that nothing moves."""

    def logged(left, right, rows=41):
        bench = gap.draw_bench("drive_log", 1, "few")
        robot = {"wheel_radius_m": RADIUS, "wheel_separation_m": WIDTH}
        spread = {name: {"value": value, "tolerance": 1e-6} for name, value in robot.items()}
        bench = replace(bench, nominal={**bench.nominal, "robot": {**spread, "encoder_ticks_per_revolution": TICKS}})
        time = ROW_S * np.arange(rows)
        still = {"x_m": np.full(rows, 0.8), "y_m": np.full(rows, 0.6), "theta_rad": np.zeros(rows)}
        ticks = {"enc_left_ticks": left * np.arange(rows), "enc_right_ticks": right * np.arange(rows)}
        volts = {"u_left_V": np.full(rows, np.nan), "u_right_V": np.full(rows, np.nan)}
        columns = {"trial": np.ones(rows), "session_time_s": time, "t_s": time, **still, **ticks, **volts}
        return bench, columns

    return logged


@pytest.fixture
def increments(part, log):
    """Predicted over the first half second: ahead, to the left [m], and the turn [rad]."""

    def predicted(robot, left, right, window=1):
        drive = part("drive_log")
        bench, columns = log(left, right)
        turns, poses = drive._turns(bench, columns), drive._poses(columns)
        return drive._pose_stage(bench, robot, columns, turns, poses)[0, window]

    return predicted


def arc(travel_left, travel_right, width=WIDTH):
    """Of a half second with these travels."""
    turn = (travel_right - travel_left) / width
    radius = 0.5 * (travel_left + travel_right) / turn
    return [radius * np.sin(turn), radius * (1.0 - np.cos(turn)), turn]


PER_TICK = 10 * 2.0 * np.pi * RADIUS / TICKS
"""Travel in half a second for each tick per row."""


@pytest.mark.parametrize(
    ("name", "parameters", "expected"),
    [
        (None, {}, arc(80 * PER_TICK, 120 * PER_TICK)),
        ("wheelbase_scale", {"scale": 1.1}, arc(80 * PER_TICK, 120 * PER_TICK, 1.1 * WIDTH)),
        ("wheel_radius_scale", {"scale": 1.1}, arc(88 * PER_TICK, 132 * PER_TICK)),
        ("wheel_radius_asymmetry", {"asymmetry": 0.1}, arc(84 * PER_TICK, 114 * PER_TICK)),
        ("encoder_ticks_scale", {"scale": 1.25}, arc(64 * PER_TICK, 96 * PER_TICK)),
        (
            "encoder_missed_ticks",
            {"side": "left", "fraction": 0.2, "threshold_rad_s": 1.0},
            arc(100 * PER_TICK, 120 * PER_TICK),
        ),
    ],
)
def test_the_pose_moves_on_an_arc_of_the_true_wheels(world, increments, name, parameters, expected):
    robot = world(*([(name, parameters)] if name else []), own=ROBOT)
    assert increments(robot, 80, 120) == pytest.approx(expected, abs=2e-5)


def test_a_fast_curve_turns_less(world, increments):
    """k |v yaw rate| of the kinematic values."""
    robot = world(("turn_slip", {"coefficient_s2_m": 0.5}), own=ROBOT)
    kinematic = arc(80 * PER_TICK, 120 * PER_TICK)[2]
    speed, rate = 100 * PER_TICK / 0.5, kinematic / 0.5
    assert increments(robot, 80, 120)[2] == pytest.approx(kinematic / (1.0 + 0.5 * speed * rate))


def test_a_marker_ahead_of_the_axle_moves_sideways_in_a_spin(world, increments):
    robot = world(("marker_offset", {"offset_m": 0.02}), own=ROBOT)
    turn = 200 * PER_TICK / WIDTH
    expected = [0.02 * (np.cos(turn) - 1.0), 0.02 * np.sin(turn), turn]
    assert increments(robot, -100, 100) == pytest.approx(expected, abs=1e-9)


def test_a_wheel_that_is_not_round_turns_the_robot_to_and_fro(world, increments):
    """The second of two windows in which the wheels turn once."""
    ticks = TICKS / 20
    swing = 0.05 * RADIUS * (np.sin(2.0 * np.pi + 0.3) - np.sin(np.pi + 0.3))
    robot = world(("wheel_eccentricity", {"side": "left", "amplitude": 0.05, "phase_rad": 0.3}), own=ROBOT)
    assert increments(robot, ticks, ticks)[2] == pytest.approx(-swing / WIDTH, rel=0.01)


def test_on_a_slope_a_straight_drive_creeps_downhill(world, increments):
    robot = world(("floor_slope", {"gradient": 0.03, "direction_rad": 0.5}), own=ROBOT)
    gone = 100 * PER_TICK
    expected = [gone * (1.0 + 0.03 * np.cos(0.5)), gone * 0.03 * np.sin(0.5), 0.0]
    assert increments(robot, 100, 100) == pytest.approx(expected)


def test_the_tracked_heading_of_a_body_askew_sees_a_straight_drive_aside(world, increments):
    robot = world(("marker_yaw", {"angle_rad": 0.05}), own=ROBOT)
    gone = 100 * PER_TICK
    assert increments(robot, 100, 100) == pytest.approx([gone * np.cos(0.05), -gone * np.sin(0.05), 0.0])


def test_a_drifting_clock_loses_a_share_of_every_window(world, increments):
    robot = world(("pose_clock_drift", {"rate": 0.02}), own=ROBOT)
    assert increments(robot, 100, 100) == pytest.approx([98 * PER_TICK, 0.0, 0.0])


def test_a_late_pose_lacks_the_last_of_the_first_window(world, increments):
    robot = world(("pose_time_offset", {"delay_s": 0.1}), own=ROBOT)
    assert increments(robot, 100, 100, window=0) == pytest.approx([80 * PER_TICK, 0.0, 0.0])
    assert increments(robot, 100, 100, window=1) == pytest.approx([100 * PER_TICK, 0.0, 0.0])


ROOM = {
    "world": {"room_x_m": 2.0, "room_y_m": 1.6},
    "tof": {
        "mount": {
            "front": {"x_m": 0.06, "y_m": 0.0, "yaw_rad": 0.0},
            "left": {"x_m": 0.0, "y_m": 0.05, "yaw_rad": np.pi / 4},
        }
    },
}


@pytest.mark.parametrize(
    ("sensor", "name", "parameters", "range_m"),
    [
        ("front", None, {}, 2.0 - 1.06),
        ("left", None, {}, np.sqrt(2.0) * (1.6 - 1.05)),
        ("front", "tof_mount_yaw", {"sensor": "front", "angle_rad": 0.2}, (2.0 - 1.06) / np.cos(0.2)),
        ("left", "tof_mount_yaw", {"sensor": "front", "angle_rad": 0.2}, np.sqrt(2.0) * (1.6 - 1.05)),
        ("front", "tof_range_scale", {"scale": 1.1}, 1.1 * (2.0 - 1.06)),
        ("front", "tof_range_offset", {"sensor": "front", "offset_m": -0.02}, 2.0 - 1.08),
        ("left", "tof_range_offset", {"sensor": "front", "offset_m": -0.02}, np.sqrt(2.0) * (1.6 - 1.05)),
    ],
)
def test_a_sensor_sees_the_first_wall(part, world, sensor, name, parameters, range_m):
    robot = world(*([(name, parameters)] if name else []), own=ROBOT)
    reading = part("drive_ranges").ranges(ROOM, robot, np.array([1.0, 1.0, 0.0]), sensor)
    assert reading == pytest.approx(range_m)


@pytest.fixture
def short_drive(gap):
    """What is known of a drive in trials of so many rows, the last of them held out."""

    def known(trials, rows, logs_voltage=1.0):
        bench = gap.draw_bench("drive_log", 3, "few")
        time, number = np.tile(ROW_S * np.arange(rows), trials), np.repeat(np.arange(1, trials + 1), rows)
        inputs = {"trial": number, "split": np.where(number == trials, "holdout", "fit")}
        inputs |= {"session_time_s": 20.0 * (number - 1) + time, "t_s": time}
        inputs |= {"logs_voltage": np.full(len(time), logs_voltage)}
        unseen = {"session_time_s": 20.0 * trials + time[:rows], "t_s": time[:rows]}
        return replace(bench, inputs=inputs, blind={"blind_tof_inputs.csv": unseen})

    return known


def test_without_voltages_large_wheels_are_a_coarse_encoder(gap, part, short_drive):
    bench = short_drive(2, 121, np.nan)
    own = bench.textbook().own
    robot = gap.World(own, (gap.Effect("wheel_radius_scale", {"scale": 1.06}),))
    columns, blind = part("drive_log").observe(bench, robot, np.random.default_rng(1))
    verdict = gap.judge(gap.Case("drive", bench, columns, blind, robot))
    assert verdict.drops[0] > gap.DETECTABLE
    assert "encoder_ticks_scale" in verdict.equivalent[0]
    assert "tof_range_scale" not in verdict.equivalent[0]


def test_a_drive_is_what_its_own_robot_predicts_from_its_log(gap, part, short_drive):
    """Simulated in closed loop, predicted stage by stage: what is left is the noise as stated."""
    drive = part("drive_log")
    bench = short_drive(1, 161)
    hidden = [
        ("supply_sag", {"source_resistance_ohm": 1.0}),
        ("input_delay", {"delay_s": 0.03}),
        ("encoder_missed_ticks", {"side": "right", "fraction": 0.1, "threshold_rad_s": 5.0}),
        ("turn_slip", {"coefficient_s2_m": 0.3}),
        ("marker_offset", {"offset_m": 0.02}),
        ("pose_time_offset", {"delay_s": 0.05}),
        ("tof_mount_yaw", {"sensor": "left", "angle_rad": 0.1}),
        ("tof_time_offset", {"delay_s": 0.08}),
    ]
    own = bench.textbook().own
    robot = gap.World(own, tuple(gap.Effect(name, numbers) for name, numbers in hidden))
    columns, _ = drive.observe(bench, robot, np.random.default_rng(4))
    frame = drive.frame(bench, columns)
    true, nominal = drive.predict(bench, columns, [robot, bench.textbook()])
    for stage in range(3):
        of = (frame.stage == stage) & np.isfinite(frame.measured)
        assert of.sum() > 30
        left, before = (np.abs((frame.measured - guess) / frame.sigma)[of] for guess in (true, nominal))
        assert 0.4 < np.median(left) < 0.85  # 0.67 of a normal deviate
        assert np.mean(left > 3.0) < 0.06
        assert np.sqrt(np.mean(before**2)) > 1.5 * np.sqrt(np.mean(left**2))


def test_drives_visit_the_room_and_are_written_with_the_columns_of_the_format(gap, part, short_drive, tmp_path):
    bench = short_drive(2, 241)
    robot = bench.textbook()
    case = gap.Case("drive", bench, *part("drive_log").observe(bench, robot, np.random.default_rng(2)), robot)
    gap.write(case, tmp_path)
    header, *lines = (tmp_path / "data.csv").read_text().splitlines()
    assert header.startswith("trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks")
    assert len(lines) == 2 * 241
    x, theta = case.columns["x_m"], case.columns["theta_rad"]
    assert np.nanmin(x) > 0.2
    assert np.nanmax(x) < 1.8
    assert np.nanmax(x) - np.nanmin(x) > 0.5
    assert np.nanmax(theta) - np.nanmin(theta) > np.pi
