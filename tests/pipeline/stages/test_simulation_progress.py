"""Progress of the simulation of several runs."""

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline.executors.local import Local
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.simulate_runs import simulate_runs
from symolo.core.progress import LineReport


class _StageBegunError(Exception):
    pass


class _Listener(LineReport):
    def stage(self, name, total, unit, *, is_even=True):
        raise _StageBegunError(name, total, unit, is_even)


@pytest.mark.parametrize("lap", [False, True])
def test_the_time_left_of_laps_does_not_follow_from_their_time_limit(tmp_path, lap):
    """A lap ends long before the limit; runs of a fixed time advance evenly."""
    specs = draw_all(load_scenario("smoke", [f"stop.lap={str(lap).lower()}"]))
    with pytest.raises(_StageBegunError) as begun:
        simulate_runs(Workspace(tmp_path), specs, Local(1), _Listener())
    assert begun.value.args == ("simulate", 2, "runs", not lap)
