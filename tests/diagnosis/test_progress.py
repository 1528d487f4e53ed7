"""The share of a diagnosis that is done."""

import pytest

from diagnosis.progress import USUAL_PREDICTIONS, DiagnosisProgress, Phase


def test_the_share_grows_from_phase_to_phase_and_stays_below_one():
    shares: list[float] = []
    progress = DiagnosisProgress(shares.append)
    for phase in Phase:
        progress.begin(phase)
        assert shares[-1] == pytest.approx(phase.value / 100)
        for _ in range(10 * USUAL_PREDICTIONS):
            progress.predicted()
    assert shares == sorted(shares)
    assert shares[-1] < 1.0


def test_a_phase_is_half_done_after_the_usual_number_of_predictions():
    shares: list[float] = []
    progress = DiagnosisProgress(shares.append)
    for _ in range(USUAL_PREDICTIONS):
        progress.predicted()
    assert shares[-1] == pytest.approx(Phase.STRUCTURE.value / 200)
