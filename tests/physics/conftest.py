"""The shipped robot and arenas, read without the project's own loader, and simulations of them."""

from pathlib import Path

import pybullet
import pytest
import yaml

from configs.schema.arena import ArenaConfig, Obstacle
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.bullet.simulation import BulletSimulation
from symolo.arena.geometry import Arena

CONFIGS = Path(__file__).parents[2] / "configs"


def read(path: str) -> dict:
    return yaml.safe_load((CONFIGS / path).read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def robot() -> RobotConfig:
    return RobotConfig.model_validate(read("robots/nominal.yaml"))


@pytest.fixture(scope="session")
def arena_config() -> ArenaConfig:
    return ArenaConfig.model_validate(read("arenas/symolo.yaml"))


@pytest.fixture(scope="session")
def arena(arena_config: ArenaConfig) -> Arena:
    return Arena.from_config(arena_config)


@pytest.fixture(scope="session")
def open_floor(arena_config: ArenaConfig) -> Arena:
    """The arena's floor with nothing standing on it."""
    return Arena.from_config(arena_config.model_copy(update={"walls": (), "obstacles": ()}))


@pytest.fixture(scope="session")
def one_block(arena_config: ArenaConfig) -> Arena:
    """One cube whose near face is 0.30 m ahead of the origin."""
    block = Obstacle(name="block", center=(0.35, 0.0), size=(0.1, 0.1, 0.1))
    return Arena.from_config(arena_config.model_copy(update={"walls": (), "obstacles": (block,)}))


@pytest.fixture
def simulate(robot, open_floor):
    """Make simulations, of the nominal robot on an empty floor where nothing else is asked, closed after the test.

    A lifted robot hangs in the air without gravity: wheels without load.
    """
    made = []

    def make(arena=open_floor, start=(0.0, 0.0, 0.0), robot=robot, *, lifted=False):
        simulation = BulletSimulation(robot, arena, start, Rates())
        made.append(simulation)
        if lifted:
            client = simulation._client
            pybullet.setGravity(0, 0, 0, physicsClientId=client)
            pybullet.resetBasePositionAndOrientation(simulation._robot, [0, 0, 1], [0, 0, 0, 1], physicsClientId=client)
        return simulation

    yield make
    for simulation in made:
        simulation.close()
