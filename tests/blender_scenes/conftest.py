"""The shipped arena and robot, read without the loader, which is not what these tests are about."""

from pathlib import Path

import pytest
import yaml

import configs
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from physics.arena import Arena

_SHIPPED = Path(configs.__file__).parent


@pytest.fixture(scope="session")
def arena() -> Arena:
    text = (_SHIPPED / "arenas" / "symolo.yaml").read_text()
    return Arena.from_config(ArenaConfig.model_validate(yaml.safe_load(text)))


@pytest.fixture(scope="session")
def robot() -> RobotConfig:
    text = (_SHIPPED / "robots" / "nominal.yaml").read_text()
    return RobotConfig.model_validate(yaml.safe_load(text))
