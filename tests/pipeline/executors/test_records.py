"""What comes back of a task on Ray, as events and failures: the same that a supervisor on this machine tells."""

from pathlib import Path

from pipeline.executors import chosen
from pipeline.executors.ray import UnitRecord
from pipeline.work.supervisor import FrameGivenUp
from pipeline.work.units import RenderUnit

UNIT = RenderUnit(name="CW/test_1", work="images", job=Path(), folder=Path(), numbers=(1, 2), threads=1)


def test_a_frame_that_was_given_up_is_reported_before_the_end_of_its_block(pretended_ray):
    pretended_ray(UnitRecord(failures=("image 1 was given up",)).model_dump_json(), CPU=1.0)
    heard = []
    failures = chosen(None, None, None, "auto").do([UNIT], lambda unit, event: heard.append((unit, event)))
    assert [(failure.unit, failure.text) for failure in failures] == [(UNIT, "image 1 was given up")]
    (first, given_up), (last, end) = heard
    assert first == last == UNIT
    assert given_up == FrameGivenUp("image 1 was given up")
    assert end.kind == "finished"
