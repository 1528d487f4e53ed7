"""The table of the state machine: what a file may say, and that a bad one is refused in one clear line."""

import pytest

from physics.control.base import Observation
from physics.control.conditions import CONDITIONS, ControlView
from physics.control.transitions import load_transitions
from symolo.core.errors import InputError
from symolo.dataset.codes import State

GOOD = "{states: [LINE], when: wall_lost(left), to: LEFT_WALL}"


def load(tmp_path, *rows):
    path = tmp_path / "table.yaml"
    path.write_text("transitions:\n" + "".join(f"  - {row}\n" for row in rows))
    return load_transitions(path)


def test_the_shipped_table_leaves_and_enters_every_state_and_asks_every_condition():
    rows = load_transitions()
    assert {state for row in rows for state in row.states} == set(State)
    assert {row.to for row in rows} == set(State)
    assert {row.condition for row in rows} == set(CONDITIONS)


def test_a_row_is_taken_in_its_states_alone_and_only_if_its_condition_holds(tmp_path, robot):
    (row,) = load(tmp_path, "{states: [LINE, LEFT_WALL], when: on_line, to: LEFT_WALL}")
    seen = Observation((0.9,) * 8, 2.0, 2.0, 2.0, (0.0, 0.0, 0.0))
    on_line, off_line = (ControlView(seen, robot.controller, e, None, State.LINE, None) for e in (0.5, None))
    taken = {state for state in State if row.taken(state, on_line)}
    assert taken == {State.LINE, State.LEFT_WALL}
    assert not any(row.taken(state, off_line) for state in State)


def test_rows_are_read_in_their_order(tmp_path):
    rows = load(tmp_path, GOOD, "{states: [LINE, TURN_LEFT], when: on_line, to: LOST_LEFT_WALL}")
    assert rows[0] == ((State.LINE,), "wall_lost", "left", State.LEFT_WALL)
    assert rows[1] == ((State.LINE, State.TURN_LEFT), "on_line", "", State.LOST_LEFT_WALL)


@pytest.mark.parametrize(
    ("row", "what", "close"),
    [
        ("{states: [LIN], when: on_line, to: LINE}", "transitions.1.states.0: got 'LIN'", "did you mean LINE"),
        ("{states: [], when: on_line, to: LINE}", "transitions.1.states", "one or more states"),
        ("{states: [LINE], when: on_lien, to: LINE}", "transitions.1.when: got 'on_lien'", "did you mean on_line"),
        ("{states: [LINE], when: wall_lost, to: LINE}", "got 'wall_lost'", "wall_lost(left | right)"),
        ("{states: [LINE], when: wall_lost(), to: LINE}", "got 'wall_lost()'", "wall_lost(left | right)"),
        ("{states: [LINE], when: wall_lost(rihgt), to: LINE}", "got 'wall_lost(rihgt)'", "did you mean right"),
        ("{states: [LINE], when: on_line(left), to: LINE}", "got 'on_line(left)'", "takes no argument"),
        ("{states: [LINE], when: avoided(LINES), to: LINE}", "got 'avoided(LINES)'", "did you mean LINE"),
        ("{states: [LINE], when: a or b, to: LINE}", "got 'a or b'", "a condition such as"),
        ("{states: [LINE], when: on_line, to: WALL}", "transitions.1.to: got 'WALL'", "one of LINE, RIGHT_WALL"),
        ("{states: [LINE], when: on_line, to: LINE, if: x}", "transitions.1.if", ""),
        ("{states: [LINE], to: LINE}", "transitions.1.when", ""),
        (GOOD, "transitions.1: never taken", "remove it"),
    ],
)
def test_a_bad_row_is_refused_with_its_line(tmp_path, row, what, close):
    with pytest.raises(InputError) as refusal:
        load(tmp_path, GOOD, row)
    text = str(refusal.value)
    assert f"table.yaml:3: {what}" in text or (what in text and "table.yaml:3: transitions.1" in text)
    assert close in text
    assert "\n" not in text
