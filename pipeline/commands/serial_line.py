"""Options of the serial line between the simulation and a controller board."""

from typing import Annotated

import typer

from symolo.core.text_enum import TextEnum


class FramingChoice(TextEnum):
    """Framings of the serial line."""

    FRAMED = "framed"
    SIMTWO = "simtwo"


Framing = Annotated[
    FramingChoice,
    typer.Option(
        "--framing",
        help="Format on the serial line: framed has sequence numbers and checksums; simtwo is the format of SimTwo.",
    ),
]


Baud = Annotated[
    int | None,
    typer.Option(
        "--baud",
        metavar="N",
        help="Baud rate: 115200, 250000, 500000 or 1000000; by default 500000, with --framing simtwo 115200.",
    ),
]
