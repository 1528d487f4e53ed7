"""Commands that make measured cases: `symolo case example`."""

from collections.abc import Mapping
from typing import Annotated

import typer

from pipeline.commands.options import NewFolder

HELP = "Make a measured case, which is a folder that `symolo diagnose` reads."


def example(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of an example, or a kind of case, such as motor_steady.")
    ],
    *,
    out: NewFolder,
) -> None:
    """Copy a small example case, on which the diagnosis can be tried without a robot.

    A simulation with hidden effects made the examples. There are two or more of each kind: motor_steady, motor_step,
    tof_bench and drive_log. The command prints which effects the case hides, so that you can compare the diagnosis with
    the truth.

    Example: symolo case example motor_steady --out my_case
    """
    from diagnosis.examples.example import example_of

    case = example_of(name)
    case.copy(out)
    typer.echo(f"{out}: the example {case.name} of the kind {case.kind}")
    typer.echo(f"It hides {_hidden(case.hidden)}. See whether the diagnosis names that:\n")
    typer.echo(f"symolo diagnose {out} --out {out}-diagnosis")


def _hidden(effects: Mapping[str, Mapping[str, object]]) -> str:
    texts = []
    for name, parameters in effects.items():
        numbers = ", ".join(
            f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in parameters.items()
        )
        texts.append(f"{name} ({numbers})" if numbers else name)
    return " and ".join(texts) or "no effect"


COMMANDS = (example,)
