"""What is said about an effect of the user's own that is tried and not named."""

from dataclasses import replace
from pathlib import Path

import pytest

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.report.sentences.effects.unnamed_own_effects import tried_effects
from pipeline.effects.template import template

ROOT = Path(__file__).parents[5]


@pytest.fixture
def loaded():
    """Load files, and forget them afterwards."""
    files = []

    def load(path):
        files.append(path)
        return EFFECTS.load(path)

    yield load
    for path in files:
        EFFECTS.unload(path)


def test_without_own_effects_nothing_is_said(diagnosis_of):
    assert list(tried_effects(diagnosis_of("weak"))) == []


def test_an_effect_of_another_kind_of_measurement_is_not_tried(diagnosis_of, loaded):
    loaded(ROOT / "examples/oval_wheel.py")
    (tried,) = tried_effects(diagnosis_of("weak"))
    assert (tried.name, tried.text) == ("oval_wheel", "not tried, since its setups lack Setup.MOTOR_BENCH")
    assert tried.drop is None


def test_an_effect_that_changes_no_prediction_says_what_would_show_it(diagnosis_of, loaded, tmp_path):
    path = tmp_path / "oval_wheel.py"
    path.write_text((ROOT / "examples/oval_wheel.py").read_text().replace("Setup.DRIVE", "Setup.MOTOR_BENCH"))
    loaded(path)
    (tried,) = tried_effects(diagnosis_of("weak"))
    predicted = "which are of current_A, omega_rad_s"
    shows = "it shows in several turns of the wheels"
    assert tried.text.startswith(f"it changes no prediction of these data, {predicted}; {shows}")


def test_an_effect_that_the_robot_lacks_has_its_size_with_its_error(diagnosis_of, loaded, tmp_path):
    """The motor has a weak magnet and no further friction."""
    path = tmp_path / "sticky.py"
    path.write_text(template("sticky", Slot.FRICTION))
    diagnosis = diagnosis_of("weak")
    library = diagnosis.candidates
    candidate = CandidateEffect(loaded(path), ())
    (tried,) = tried_effects(replace(diagnosis, candidates=replace(library, testable=(*library.testable, candidate))))
    assert abs(tried.values["extra_N_m"]) < 3.0 * tried.std["extra_N_m"]
    assert 0.0 <= tried.drop < 15.0
    assert tried.text.startswith("not named: beside the named effects, the cost falls by ")
    assert "extra_N_m" in tried.text
