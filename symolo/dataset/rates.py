"""The rate of the images beside that of the rows of data.csv."""

from typing import Annotated, Protocol

from pydantic import PlainSerializer


def _short(rate_hz: float) -> int | float:
    return int(rate_hz) if float(rate_hz).is_integer() else rate_hz


Rate = Annotated[float, PlainSerializer(_short, return_type=int | float)]
"""Rate [Hz]; a whole number is written without a decimal point."""


IMAGE_HZ = 5
"""Image rate of SyMoLo."""


class RowAndImageRates(Protocol):
    """Rates of the rows of data.csv and of the images."""

    @property
    def control_hz(self) -> int: ...
    @property
    def camera_hz(self) -> float: ...


def period_beside_rows_s(rates: RowAndImageRates | None) -> float | None:
    """Return the time between two images [s]; None if every image is taken at a row of data.csv, or if there is none.

    The images of an imported trajectory, which has no rates, are at its rows.
    """
    if rates is None or not rates.camera_hz or (rates.control_hz / rates.camera_hz).is_integer():
        return None
    return 1 / rates.camera_hz
