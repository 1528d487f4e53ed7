"""One thing that a bench must show, and whether it did."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    what: str
    holds: bool
    found: str
    wanted: str

    def line(self) -> str:
        return f"{'holds ' if self.holds else 'MISSED'}  {self.what}: {self.found} (wanted: {self.wanted})"
