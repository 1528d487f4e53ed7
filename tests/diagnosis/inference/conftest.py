"""A made-up bench whose answers are closed forms: a current proportional to x, read through the sensor's effects."""

import importlib
from dataclasses import dataclass

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from diagnosis.case_robot import base_robot_of, nominal_of, spreads_of
from diagnosis.importers import IMPORTERS
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.nuisances import Nuisance
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Covariate, Observed, Predicted
from physics.robot.model import RobotModel
from sensors.wheels.instruments import read_current_A

TOLERANCE = 0.02
SD_A = 0.01


def scaled(robot, value):
    return robot.model_copy(update={"motor": robot.motor.model_copy(update={"torque_constant_N_m_A": value})})


@dataclass
class Bench:
    """I = x K/K_nominal, read by the current sensor."""

    observed: tuple
    x: np.ndarray
    nominal_constant: float
    name: str = "motor"
    at_once: int = 48

    def predict(self, robots):
        constants = [RobotModel.from_config(robot).motors.right.torque_constant_N_m_A for robot in robots]
        rows = [
            read_current_A(robot.effects, self.x * constant / self.nominal_constant, np.zeros(()))
            for robot, constant in zip(robots, constants, strict=True)
        ]
        return (Predicted(np.array(rows), self.observed[0].sd),)


@pytest.fixture(scope="session")
def robot():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


@pytest.fixture(scope="session")
def hypothesis(robot):
    constant = robot.motor.torque_constant_N_m_A
    return Hypothesis(
        robot, (Nuisance("motor.torque_constant_N_m_A", constant, TOLERANCE * constant, "N m/A", scaled),)
    )


@pytest.fixture(scope="session")
def effect():
    effects = EFFECTS.by_name()
    return lambda name, **choices: CandidateEffect(effects[name], tuple(choices.items()))


@pytest.fixture(scope="session")
def evidence_of(robot):
    """Evidence of readings at x, the last `heldout` rows held out."""

    def make(x, readings, heldout=0, trials=1, **covariates):
        n = len(x)
        observed = Observed(
            name="current_A",
            channel="current_A",
            unit="A",
            values=np.array(readings, dtype=float),
            sd=np.full(n, SD_A),
            correlation=0.0,
            trial=np.arange(n) * trials // n,
            t_s=np.arange(n, dtype=float),
            holdout=np.arange(n) >= n - heldout,
            usable=np.isfinite(readings),
            covariates=(Covariate("x", np.array(x)), *(Covariate(k, np.array(v)) for k, v in covariates.items())),
        )
        return Evidence((Bench((observed,), np.array(x), robot.motor.torque_constant_N_m_A),))

    return make


@pytest.fixture(scope="module")
def step_log(tmp_path_factory, cases_on_the_path):
    """Readings of a motor with hidden effects, whose numbers are given by their names, and the nominal fit."""
    del cases_on_the_path
    made = {}

    def make(seed, **effects):
        key = seed, str(effects)
        if key not in made:
            made[key] = fitted(seed, effects)
        return made[key]

    def fitted(seed, effects):
        cases, folder = importlib.import_module("gap_cases"), tmp_path_factory.mktemp("steps") / "case"
        cases.write(cases.make_case("motor_step", seed, list(effects.items()), rows="few"), folder)
        (reader,) = (importer for importer in IMPORTERS if importer.name == "motor_step")
        measurement = reader.read(folder)
        robot = nominal_of(measurement, base_robot_of(measurement, None))
        evidence = Evidence(STAGES[measurement.kind](measurement, robot))
        bare = Hypothesis(robot, spreads_of(measurement, robot))
        return evidence, fits(evidence, [(bare, bare.null())])[0]

    return make
