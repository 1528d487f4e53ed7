"""The state machine's table, read from configs/state_machine.yaml: which state follows which, and when.

hil/generate.py writes the firmware's table from the same rows.
"""

import re
from functools import cache
from pathlib import Path
from typing import Annotated, NamedTuple

import configs
from configs.schema.base import FromList, Section
from configs.validation.values import validated
from physics.control.conditions import CONDITIONS, STATES, ControlView
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.reader import read_yaml
from symolo.core.yaml.tree import Node
from symolo.dataset.codes import State

TABLE = Path(configs.__file__).parent / "state_machine.yaml"

_CALL = re.compile(r"(?P<name>\w+)(\((?P<argument>\w*)\))?")


class Transition(NamedTuple):
    """A change from any of `states` to `to` if the condition holds."""

    states: tuple[State, ...]
    condition: str
    """Name in `CONDITIONS`."""
    argument: str
    """Argument of the condition; empty if it takes none."""
    to: State

    def taken(self, state: State, view: ControlView) -> bool:
        return state in self.states and CONDITIONS[self.condition].holds(view, self.argument)


class _Row(Section):
    states: Annotated[tuple[str, ...], FromList]
    when: str
    to: str


class _Table(Section):
    transitions: Annotated[tuple[_Row, ...], FromList]


@cache
def load_transitions(path: Path = TABLE) -> tuple[Transition, ...]:
    """Return the rows in the order in which they are tried.

    Raises:
        InputError: The file is not a table of known states and conditions.
    """
    root = read_yaml(path).root
    table = validated(root, _Table, {})
    rows: list[Transition] = []
    for index, written in enumerate(table.transitions):
        row = _checked(root, index, written)
        _refuse_dead(root, index, row, rows)
        rows.append(row)
    return tuple(rows)


def _checked(root: Node, index: int, row: _Row) -> Transition:
    what = f"transitions.{index}"
    if not row.states:
        raise InputError(f"{what}.states", where=_place(root, index, "states"), got=[], allowed="one or more states")
    states = tuple(
        State[_known(name, STATES, f"{what}.states.{n}", _place(root, index, "states"))]
        for n, name in enumerate(row.states)
    )
    to = State[_known(row.to, STATES, f"{what}.to", _place(root, index, "to"))]
    return Transition(states, *_called(row.when, f"{what}.when", _place(root, index, "when")), to)


def _called(when: str, what: str, where: str) -> tuple[str, str]:
    """Return name and argument of a condition."""
    call = _CALL.fullmatch(when)
    if call is None:
        allowed = "a condition such as on_line or wall_lost(left)"
        raise InputError(what, where=where, got=when, allowed=allowed)
    name = _known(call["name"], tuple(CONDITIONS), what, where)
    argument, arguments = call["argument"] or "", CONDITIONS[name].arguments
    if arguments and argument not in arguments:
        allowed = f"{name}({' | '.join(arguments)})"
        raise InputError(what, where=where, got=when, allowed=allowed, nearest=nearest(argument, arguments))
    if not arguments and argument:
        raise InputError(what, where=where, got=when, allowed=f"{name}, which takes no argument")
    return name, argument


def _known(name: str, names: tuple[str, ...], what: str, where: str) -> str:
    if name not in names:
        allowed = f"one of {', '.join(names)}"
        raise InputError(what, where=where, got=name, allowed=allowed, nearest=nearest(name, names))
    return name


def _refuse_dead(root: Node, index: int, row: Transition, earlier: list[Transition]) -> None:
    """Refuse a row that can never be taken, since earlier rows have its condition for all of its states."""
    covered = {(state, above.condition, above.argument) for above in earlier for state in above.states}
    if all((state, row.condition, row.argument) in covered for state in row.states):
        cure = "remove it, or move it up"
        raise InputError(
            f"transitions.{index}: never taken, because rows above have the same condition",
            where=_place(root, index, "when"),
            cure=cure,
        )


def _place(root: Node, index: int, field: str) -> str:
    return root.place_of(("transitions", index, field))
