"""A new measured case from a log: mapping, rows, nominal parameters, and what is missing for more."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.case_format import DATA, RANGE_SIDES, VOLTAGES
from diagnosis.measured.case_files.nominal import NOMINAL
from diagnosis.measured.case_files.write_case import csv_of, voltages_of
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.new_case.known_numbers import KnownNumber, missing, numbers_of
from diagnosis.new_case.nominal_text import compared_sides, nominal_text
from diagnosis.new_case.quantities import KINDS
from diagnosis.new_case.rows import measurement_of
from logs.log_file import LogFile
from logs.mapping import MAPPING, LogMapping, mapping_text
from symolo.core.errors import FaultsError, InputError, together
from symolo.core.files.atomic_files import write_file
from symolo.core.files.new_folder import new_folder
from symolo.core.yaml.reader import displayed

_STAGES: Mapping[str, tuple[tuple[tuple[str, ...], str], ...]] = {
    "speeds of the wheels from voltages": (
        (("u_left_V", "u_right_V"), "voltages of both motors"),
        (("enc_left_ticks", "enc_right_ticks"), "ticks of both encoders"),
    ),
    "changes of the pose from ticks": (
        (("enc_left_ticks", "enc_right_ticks"), "ticks of both encoders"),
        (("x_m", "y_m", "theta_rad"), "poses"),
    ),
}
"""What a drive compares, and the channels that it needs, with their names."""


@dataclass(frozen=True)
class NewCase:
    """A case that is not written yet."""

    log: LogFile
    mapping: LogMapping
    measurement: Measurement
    known: Mapping[str, float]
    """Numbers that the user gave, by key."""

    @property
    def numbers(self) -> tuple[KnownNumber, ...]:
        """Numbers that matter for this log."""
        return numbers_of(self.measurement)

    def knowing(self, known: Mapping[str, float]) -> "NewCase":
        """Return the case with these numbers in addition."""
        return replace(self, known={**self.known, **known})

    def write(self, out: Path) -> Measurement:
        """Write the case into a new folder, and return it as it is read back.

        Raises:
            InputError: A number is missing that cannot be estimated, or the case cannot be read back.
        """
        text = nominal_text(self.measurement, self.known)
        with new_folder(out) as folder:
            write_file(folder / DATA, csv_of(self.measurement).encode())
            if voltages := voltages_of(self.measurement):
                write_file(folder / VOLTAGES, voltages.encode())
            write_file(folder / NOMINAL, text.encode())
            write_file(folder / MAPPING, self._mapping_text(out).encode())
            try:
                return read_measurement(folder, IMPORTERS)
            except InputError as error:
                faults = error.faults if isinstance(error, FaultsError) else (error,)
                texts = [str(fault).replace(f"{displayed(folder)}/", "").replace(f"{folder}/", "") for fault in faults]
                raise together([InputError(text, where=f"{self.log.path}: as a case") for text in texts]) from None

    def _mapping_text(self, out: Path) -> str:
        command = ["symolo", "case", "init", f"{self.log.path}", "--mapping", f"{out / MAPPING}", "--out", f"{out}-2"]
        return mapping_text(self.mapping, KINDS[CaseKind(self.mapping.kind)], self.log, command)

    def compared(self) -> list[str]:
        """Return one sentence for each comparison that the diagnosis can or cannot make."""
        if self.measurement.kind is not CaseKind.DRIVE_LOG:
            return list(self._bench_comparisons())
        return list(self._drive_comparisons())

    def _bench_comparisons(self) -> Sequence[str]:
        names = {
            CaseKind.MOTOR_STEADY: ("current_A", "omega_rad_s"),
            CaseKind.MOTOR_STEP: ("current_A", "omega_rad_s"),
        }.get(self.measurement.kind, ("reading_m",))
        logged = [name for name in names if self.measurement.has(name)]
        return [
            f"compared: {', '.join(logged)}",
            *(f"not compared: {name}, because it was not logged" for name in names if name not in logged),
        ]

    def _drive_comparisons(self) -> Sequence[str]:
        lines = []
        for title, needs in _STAGES.items():
            lacking = [name for channels, name in needs if not self.measurement.has(*channels)]
            reason = f", because the log lacks {' and '.join(lacking)}" if lacking else ""
            lines.append(f"{'not compared' if lacking else 'compared'}: {title}{reason}")
        sides = compared_sides(self.measurement, self.known)
        for side in RANGE_SIDES:
            if side in sides:
                lines.append(f"compared: range of the {side} sensor")
            elif self.measurement.has(f"tof_{side}_m"):
                keys = ["room_x_m", "room_y_m", *(f"{side}_{end}" for end in ("x_m", "y_m", "yaw_deg"))]
                lacking = [key for key in keys if key not in self.known]
                has_pose = self.measurement.has("x_m", "y_m", "theta_rad")
                reason = f"{', '.join(lacking)} not given" if has_pose else "the log lacks poses"
                lines.append(f"not compared: range of the {side} sensor, because {reason}")
        if not any(self.measurement.has(f"tof_{side}_m") for side in RANGE_SIDES):
            lines.append("not compared: ranges, because the log lacks them")
        return lines

    def unknown(self) -> list[str]:
        """Return one line for each number that was not given, with what it would allow the diagnosis to name."""
        numbers = missing(self.numbers, self.known)
        width = max((len(number.key) for number in numbers), default=0)
        return [f"{number.key:{width}}  {number.title}; allows: {number.allows}" for number in numbers]


def new_case(log: LogFile, mapping: LogMapping, name: str) -> NewCase:
    """Return a case for a log, without known numbers.

    Raises:
        InputError: The rows of the log cannot be used; the message names every fault.
    """
    return NewCase(log, mapping, measurement_of(log, mapping, name), {})
