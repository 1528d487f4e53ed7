"""How a case of measured data is read: by which importer, which part of it, and which of its trials are held out."""

from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict

if TYPE_CHECKING:
    from diagnosis.measured.measurement import Measurement


class Reading(BaseModel):
    """What the user asked for, the same of all cases."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    importer: str | None = None
    """By name; None for the one that recognises a case."""
    part: str | None = None
    """The only part of the robot to look at; None for all."""
    held_out: tuple[str, ...] = ()
    """Patterns of the trials to hold out; empty for those that the source or its importer holds out."""

    def measurement(self, path: Path) -> "Measurement":
        """The case.

        Raises:
            InputError: It cannot be read, or has no such part or trials.
        """
        # Importers load much, and most workers that know this class read no case.
        from diagnosis.importers.choose import read_measurement  # noqa: PLC0415
        from diagnosis.measured.holdout import hold_out, of_part  # noqa: PLC0415
        from pipeline.diagnosing.importers import IMPORTERS  # noqa: PLC0415

        found = read_measurement(path, IMPORTERS, self.importer)
        if self.part is not None:
            found = of_part(found, self.part)
        return hold_out(found, self.held_out) if self.held_out else found
