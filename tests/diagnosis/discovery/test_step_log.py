"""A law that is hidden in a step log by its closed form, and the draws of signs of a log."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.discovery.discover import with_law
from diagnosis.discovery.search import runs_of_one_sign
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.naming.verdict import CaseVerdict
from pipeline.effects.check import load_to_fit
from pipeline.effects.contract import RULES, judged
from pipeline.effects.trial import EffectTrial

R, K, B, J = 3.0, 0.3, 0.002, 2e-3
NOMINAL = f"""kind: motor_step
motor:
  winding_resistance_ohm: {{value: {R}, tolerance: 0.01}}
  torque_constant_N_m_A: {{value: {K}, tolerance: 0.001}}
  viscous_friction_N_m_s_rad: {{value: {B}, tolerance: 0.00002}}
  coulomb_friction_N_m: {{value: 1.0e-9, tolerance: 1.0e-10}}
  rotor_inertia_kg_m2: {{value: {J}, tolerance: 0.00002}}
  supply_voltage_V: 6.0
  motor_side_inertia_fraction: 0.5
  motor_side_friction_fraction: 0.5
sample_rate_Hz: 100
noise: {{current_A: 0.01, omega_rad_s: 0.05, lag1_correlation: 0.0}}
"""
DEAD_V, PERIOD_S, ROWS = 0.6, 0.01, 100


def step_log(folder):
    """Return a log of a motor without dry friction whose bridge gives nothing below 0.6 V, with a voltage per row: its
    speed is an exponential in each row.
    """
    noise = np.random.Generator(np.random.PCG64(5))
    damping = K**2 / R + B
    lines = ["trial,split,session_time_s,t_s,u_cmd_V,current_A,omega_rad_s"]
    for trial in range(1, 7):
        speed = 0.0
        times_s = PERIOD_S * np.arange(1, ROWS + 1)
        command = (noise.uniform(1.0, 1.5) * np.sin(2.0 * np.pi * noise.uniform(1.0, 3.0) * times_s)).round(4)
        for row, volts in enumerate(command.tolist(), 1):
            given = volts if abs(volts) > DEAD_V else 0.0
            final = K * given / R / damping
            speed = final + (speed - final) * np.exp(-damping * PERIOD_S / J)
            current = (given - K * speed) / R + 0.01 * noise.standard_normal()
            read = speed + 0.05 * noise.standard_normal()
            t_s = row * PERIOD_S
            session_s = (trial - 1) * ROWS * PERIOD_S + t_s
            split = "holdout" if trial % 3 == 0 else "fit"
            lines.append(f"{trial},{split},{session_s:.4f},{t_s:.4f},{volts},{current:.5f},{read:.5f}")
    (folder / "nominal.yaml").write_text(NOMINAL)
    (folder / "data.csv").write_text("\n".join(lines) + "\n")
    return read_measurement(folder, IMPORTERS)


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory, diagnosed_among):
    before = diagnosed_among(step_log(tmp_path_factory.mktemp("steps")))
    assert before.conclusion is CaseVerdict.UNEXPLAINED
    return with_law(before)


def test_a_dead_zone_of_the_voltage_is_found_between_the_voltages_where_it_was_hidden(diagnosis):
    law = diagnosis.law
    assert law.name == "voltage_dead_zone_over_voltage"
    observed = diagnosis.evidence.observed[0]
    (voltage_V,) = (each.values for each in observed.covariates if each.name == "u_cmd_V")
    sizes = np.abs(voltage_V[~observed.holdout])
    assert sizes[sizes < DEAD_V].max() <= law.values["below_V"] <= sizes[sizes > DEAD_V].min()
    assert law.left is None
    assert law.gain.after < 1.1 < law.gain.before


def test_its_file_keeps_the_rules_and_names_its_range(diagnosis, tmp_path):
    law = diagnosis.law
    path = tmp_path / law.file
    path.write_text(law.text)
    assert "Seen for u_cmd_V from -1." in path.read_text()
    effect = load_to_fit(path)
    EFFECTS.unload(path)
    rules = [rule for rule in RULES if rule.name in {"texts", "bounds", "units"}]
    assert [v.problem for v in judged(EffectTrial(effect), rules) if v.problem] == []


def test_signs_are_drawn_for_runs_of_a_log_and_for_each_row_of_a_sweep():
    """Runs of four rows without correlation, and of twelve with one of 0.5; none goes on into the next trial."""
    log, sweep = SimpleNamespace(is_series=True), SimpleNamespace(is_series=False)
    evidence = SimpleNamespace(
        observed=(log, log, sweep),
        correlations=(0.0, 0.5, 0.0),
        quantity=np.repeat([0, 1, 2], [10, 26, 3]),
        trial=np.repeat([0, 1, 0, 0], [6, 4, 26, 3]),
    )
    runs = runs_of_one_sign(evidence, np.arange(39))
    assert runs.tolist() == [0, 4, 6, 10, 22, 34, 36, 37, 38]


def test_a_jump_is_tried_again_between_its_best_value_and_the_next_ones(diagnosis):
    form = replace(diagnosis.law.form, tries=((0.2,), (0.5,), (0.9,)), jump=0)
    np.testing.assert_allclose(form.finer((0.5,), 8).tries, np.linspace(0.2, 0.9, 8)[:, None])
    np.testing.assert_allclose(form.finer((0.9,), 3).tries, [[0.5], [0.7], [0.9]])
