"""Which images stand for a state: those of it, of as many runs as can be, and of different times."""

from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from symolo.report.state_sheets import MAX_IMAGES, StateImage, images_of_states


def runs(*of_states):
    """A stand-in for the facts of runs, with an image in each of these states a fifth of a second apart."""
    return [
        SimpleNamespace(
            record=SimpleNamespace(run=f"CW/test_{i}"),
            images=tuple((number, state, 0.2 * number) for number, state in enumerate(states, start=1)),
        )
        for i, states in enumerate(of_states, start=1)
    ]


@given(st.lists(st.lists(st.sampled_from([0, 1, 5, 33]), max_size=40), max_size=9))
def test_every_state_that_was_seen_has_images_of_it(of_states):
    facts = runs(*of_states)
    images = images_of_states(facts)
    assert list(images) == sorted({state for states in of_states for state in states})
    known = {(f"CW/test_{i}", n): s for i, states in enumerate(of_states, 1) for n, s in enumerate(states, 1)}
    for state, shown in images.items():
        assert {known[one.run, one.number] for one in shown} == {state}
        assert len(set(shown)) == len(shown) <= MAX_IMAGES
        having = sum(state in states for states in of_states)
        assert len({one.run for one in shown}) == min(having, MAX_IMAGES)
        if all(states.count(state) >= MAX_IMAGES for states in of_states if state in states):
            assert len(shown) == MAX_IMAGES


def test_two_runs_take_turns_over_their_time():
    (shown,) = images_of_states(runs([0] * 60, [0] * 60)).values()
    assert [(one.run, one.number) for one in shown] == [
        ("CW/test_1", 6),
        ("CW/test_1", 26),
        ("CW/test_1", 46),
        ("CW/test_2", 16),
        ("CW/test_2", 36),
        ("CW/test_2", 56),
    ]
    assert shown[0] == StateImage("CW/test_1", 6, 0.2 * 6)
