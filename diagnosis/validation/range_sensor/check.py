"""One thing that a bench must show, and whether it did."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    what: str
    holds: bool | None
    """None where too little was measured to say."""
    found: str
    wanted: str

    def line(self) -> str:
        verdict = "open  " if self.holds is None else "holds " if self.holds else "MISSED"
        return f"{verdict}  {self.what}: {self.found} (wanted: {self.wanted})"
