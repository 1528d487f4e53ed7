import pytest

from configs.draw import draw_run
from configs.loader import load_scenario


@pytest.fixture(scope="session")
def robot():
    return draw_run(load_scenario("symolo"), "CW", 1).robot
