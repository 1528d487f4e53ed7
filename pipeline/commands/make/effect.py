"""Commands for effects, also a user's own: `symolo effect check`, `new`, `list`, `show`, `extract`."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input
from pipeline.commands.user_files import NewCode, conclude_check, extract_command, write_template
from symolo.core.errors import InputError

HELP = "Write and check an effect of your own, or look at those that there are."

_DEFAULT_SLOT = "range"


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the effect, such as oval_wheel.")],
    *,
    slot: Annotated[
        str | None,
        typer.Option(
            metavar="SLOT",
            help="Place in the signal chain where it acts; `effect list` shows them. By default it is `range`.",
        ),
    ] = None,
    out: NewCode = None,
) -> None:
    """Write a file with an effect of your own to begin with, which `effect check` accepts.

    Example: symolo effect new oval_wheel --slot rolling
    """
    from pipeline.effects.template import slot_named, template
    from pipeline.effects.template_laws import LAWS

    file = write_template(name, out, template(name, slot_named(_DEFAULT_SLOT if slot is None else slot)))
    if slot is None:
        others = ", ".join(sorted(one for one in LAWS if one != _DEFAULT_SLOT))
        typer.echo(f"It acts in the slot '{_DEFAULT_SLOT}', because --slot was not given; others are: {others}.")
        typer.echo("`symolo effect list` shows what acts in each slot.")
    typer.echo(f"{file}: change it as you like, then: symolo effect check {file}")


def check(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", callback=checked_input, help="Python file that defines an effect.")
    ],
) -> int:
    """Check a file with an effect of your own, and explain each rule.

    The rules are those that the shipped effects keep. The exit code is 0 if the effect keeps all, and 2 if not. The
    command executes the file: check only files that you have read.

    Example: symolo effect check examples/oval_wheel.py
    """
    from pipeline.effects.check import check as checked_of
    from pipeline.effects.check import check_text
    from symolo.core.extras import check_installed

    check_installed("pybullet")
    checked = checked_of(file)
    trial = None
    if checked.is_good:
        settings = [word for setting in checked.settings for word in ("--set", setting)]
        trial = ["--effect-file", str(file), "simulate", "smoke", *settings]
    return conclude_check(file, check_text(checked), trial)


def list_(
    *,
    slot: Annotated[str | None, typer.Option(metavar="SLOT", help="Only those of one slot, such as 'range'.")] = None,
) -> None:
    """List all effects with their slots and causes.

    Example: symolo effect list --slot range
    """
    from configs.effects.base import Slot
    from pipeline.effects.listing import effect_lines
    from symolo.core.errors import nearest

    known = {one.value: one for one in Slot}
    name = slot.lower().replace("-", " ").replace("_", " ") if slot is not None else None
    if name is not None and name not in known:
        raise InputError("--slot", got=slot, allowed=", ".join(known), nearest=nearest(name, known))
    for line in effect_lines(None if name is None else known[name]):
        typer.echo(line)
    typer.echo("`symolo effect show NAME` explains one effect, with its equation and its parameters.")


def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of an effect.")],
) -> None:
    """Show an effect with its cause, its parameters, their bounds and its equation.

    Example: symolo effect show supply_sag
    """
    from configs.effects.registry import EFFECTS
    from pipeline.effects.listing import effect_text

    for line in effect_text(EFFECTS.named(name)):
        typer.echo(line)


COMMANDS = (new, check, list_, show, extract_command("effect"))
