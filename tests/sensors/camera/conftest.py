"""The shipped robot, read without the loader."""

from pathlib import Path

import pytest
import yaml

import configs
from configs.schema.robot import RobotConfig


@pytest.fixture(scope="session")
def robot() -> RobotConfig:
    text = (Path(configs.__file__).parent / "robots" / "nominal.yaml").read_text()
    return RobotConfig.model_validate(yaml.safe_load(text))
