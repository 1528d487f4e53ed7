"""The share of a diagnosis that is done."""

import pytest

from diagnosis.progress import USUAL_ROBOTS_OF, DiagnosisProgress, Phase


def test_the_share_grows_from_phase_to_phase_and_stays_below_one():
    shares: list[float] = []
    progress = DiagnosisProgress(shares.append)
    for phase in Phase:
        progress.begin(phase)
        assert shares[-1] == pytest.approx(phase.value / 100)
        for _ in range(100):
            progress.predicted(50)
    assert shares == sorted(shares)
    assert shares[-1] < 1.0


def test_a_phase_is_half_done_after_the_usual_number_of_robots():
    shares: list[float] = []
    progress = DiagnosisProgress(shares.append)
    for _ in range(2):
        progress.predicted(USUAL_ROBOTS_OF[Phase.SELECTION] // 2)
    assert shares[-1] == pytest.approx(Phase.STRUCTURE.value / 200)


@pytest.mark.parametrize(
    ("share", "phase"), [(0.0, Phase.SELECTION), (0.4499, Phase.SELECTION), (0.45, Phase.STRUCTURE), (1.0, Phase.PLOTS)]
)
def test_the_phase_follows_from_the_share(share, phase):
    assert Phase.at(share) is phase


def test_the_fits_that_remain_are_counted_and_the_first_ones_named():
    texts: list[str] = []
    progress = DiagnosisProgress(lambda _: None, texts.append)
    progress.fits(["turn_slip", "input_delay", "turn_slip", "floor_slope"], 9)
    assert texts == ["4 of 9 models are still being fitted (turn_slip, input_delay, ...)"]
    progress.fits(["no effect"], 1)
    assert texts[1:] == ["1 of 1 models are still being fitted (no effect)"]
    progress.begin(Phase.PLOTS)
    assert texts[-1] == "", "a phase that fits nothing has no fits that remain"
