"""Sentences about the errors of sessions."""

import pytest

from diagnosis.inference.evidence.sessions import FittedError
from diagnosis.report.sentences.data import sessions

KIND = {
    "marker_yaw": "angle_rad",
    "marker_offset": "offset_m",
    "pose_time_offset": "delay_s",
    "pose_clock_drift": "drift",
}


@pytest.mark.parametrize(
    ("effect", "values", "text"),
    [
        ("pose_time_offset", (-0.051,), "the logged pose is newer than its row by 51.0 ± 2.0 (a) ms."),
        ("pose_time_offset", (0.016, 0.08), "older than its row by 16.0 ± 2.0 (a), 80.0 ± 2.0 (b) ms."),
        ("marker_offset", (-0.02, 0.03), "is ahead of the axle by 30.0 ± 2.0 (b) mm, and behind the axle by 20.0"),
        ("marker_yaw", (-0.008,), "the tracked heading is behind that of the robot by 8.0 ± 2.0 (a) mrad."),
        ("pose_clock_drift", (-0.003,), "the logged pose gets newer by 3.0 ± 2.0 (a) ms per s."),
    ],
)
def test_a_number_below_zero_is_stated_by_the_opposite_word(monkeypatch, effect, values, text):
    errors = [
        FittedError(session, effect, KIND[effect], value, 0.002, "")
        for session, value in zip("ab", values, strict=False)
    ]
    monkeypatch.setattr(sessions, "fitted_errors", lambda _: errors)
    (sentence,) = sessions.session_sentences(None)
    assert text in sentence
    assert "-" not in sentence
