"""Times of day and dates in the cells of a log, such as `2026-05-04T10:00:59.123+02:00`, as seconds."""

import re
from collections.abc import Sequence
from datetime import date
from fractions import Fraction
from itertools import pairwise

CLOCK_TIMES = "a time of day such as 10:00:59.123, or a date and time such as 2026-05-04T10:00:59.123"
"""Times that are read, for messages."""
_CLOCK = re.compile(
    r"((?P<y>\d{4})[-/](?P<m>\d\d?)[-/](?P<d>\d\d?)[T ] *|(?P<d2>\d\d?)\.(?P<m2>\d\d?)\.(?P<y2>\d{4}) +)?"
    r"(?P<hour>\d\d?):(?P<minute>[0-5]\d):(?P<second>[0-6]\d)([.,](?P<part>\d{1,12}))?"
    r" *(Z|UTC|(?P<sign>[-+])(?P<zone_hour>\d\d):?(?P<zone_minute>\d\d)?)?"
)
_DAY_S = 86400


def seconds_of(cells: Sequence[str]) -> tuple[str, ...] | None:
    """Return times as numbers of seconds since the first one; None if a cell is no time. Empty cells stay empty.

    Dates are those of ISO 8601, with the year first, or German ones with points. Times alone go on at midnight.
    """
    known: list[tuple[Fraction, bool]] = []
    for cell in filter(None, cells):
        time = _seconds(cell)
        if time is None:
            return None
        known.append(time)
    if not known:
        return None
    seconds, days = [known[0][0]], 0
    for (before, _), (after, has_date) in pairwise(known):
        days += not has_date and after - before < -_DAY_S // 2
        seconds.append(after + days * _DAY_S)
    texts = iter([f"{float(time - seconds[0]):.9f}" for time in seconds])
    return tuple(next(texts) if cell else "" for cell in cells)


def _seconds(cell: str) -> tuple[Fraction, bool] | None:
    """Return the seconds of a time, which may be since a date, and whether it has one; None if the cell is no time."""
    match = _CLOCK.fullmatch(cell)
    if match is None:
        return None
    year, month, day = (match[name] or match[f"{name}2"] for name in "ymd")
    try:
        days = date(int(year), int(month), int(day)).toordinal() if year else 0
    except ValueError:
        return None
    zone_s = 3600 * int(match["zone_hour"] or 0) + 60 * int(match["zone_minute"] or 0)
    day_s = 3600 * int(match["hour"]) + 60 * int(match["minute"]) + int(match["second"])
    part = Fraction(int(match["part"] or 0), 10 ** len(match["part"] or ""))
    return days * _DAY_S + day_s + part - (-zone_s if match["sign"] == "-" else zone_s), bool(year)
