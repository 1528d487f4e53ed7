"""Cases of measured data diagnosed side by side, each into a folder of its own, whatever the number of workers."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.importers.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_format import BLIND, DATA
from diagnosis.measured.nominal import NOMINAL
from pipeline.diagnosing.case_reading import Reading
from pipeline.diagnosing.importers import IMPORTERS
from pipeline.diagnosing.importers.run_folder import robots_of
from pipeline.work.supervisor import AnyEvent, AnyUnit, Retried, UnitFailure, run_units
from pipeline.work.units import TRACEBACK, DiagnoseUnit, Failed, Finished
from symolo.core.atomic_files import make_folder, remove_file, write_file
from symolo.core.errors import InputError
from symolo.core.progress import Report
from symolo.dataset.layout import STAGES

ONE_THREAD = MappingProxyType({"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"})
"""Sums of a linear algebra that shares its work among threads depend on their number, and workers fill the cores."""


@dataclass(frozen=True)
class Case:
    path: Path
    name: str
    """Of its folder in the output."""


@dataclass(frozen=True)
class Asked:
    """Of all cases."""

    reading: Reading
    nominal: str
    """A robot as JSON text; empty for none."""
    pybullet: bool
    """Whether before and after are also measured by PyBullet."""
    against: Path | None
    """A dataset that is held against each case."""


def cases_of(paths: Sequence[Path]) -> list[Case]:
    """The cases with their names.

    Raises:
        InputError: Two of them would go into one folder.
    """
    found: dict[str, Case] = {}
    for path in paths:
        case = Case(path, _name(path))
        other = found.setdefault(case.name.lower(), case)
        if other is not case:
            cure = "diagnose them into two folders"
            raise InputError(f"another case has the name {case.name}: {other.path}", where=str(path), cure=cure)
    return list(found.values())


def _name(path: Path) -> str:
    whole = path.absolute()
    if whole.name in {DATA, NOMINAL}:
        return whole.parent.name
    name = whole.stem if path.is_file() else whole.name
    return f"{name}_" if name in {"", STAGES} else name


def nominal_json(name: str | None, against: Path | None = None) -> str:
    """A robot by name or file, else that of a dataset whose runs had the same, as JSON text; empty for none.

    Raises:
        InputError: There is no such robot, or it is no single one; there is no such dataset.
    """
    if name is None and against is not None and len(robots := robots_of(against)) == 1:
        return robots[0].model_dump_json()
    if name is None:
        return ""
    section = load_section("robot", name, option="--nominal")
    if section.placed:
        field = ".".join(map(str, next(iter(section.placed))))
        cure = "write a number in its place"
        raise InputError(f"{field}: a nominal robot has no distributions", where=f"--nominal {name}", cure=cure)
    robot, _ = draw_robot(section, 0, "diagnosis")
    return robot.model_dump_json()


def diagnose_cases(
    cases: Sequence[Case], asked: Asked, *, out: Path, workers: int, report: Report
) -> list[UnitFailure]:
    """Diagnose all cases and return those that failed, in their order.

    Raises:
        InputError: The only case is bad.
    """
    alone = len(cases) == 1
    units = [
        DiagnoseUnit(
            name=case.name,
            case=case.path,
            reading=asked.reading,
            nominal=asked.nominal,
            pybullet=asked.pybullet,
            against=asked.against,
            folder=folder_of(case, out, alone=alone),
            alone=alone,
        )
        for case in cases
    ]
    with report.stage("diagnose", len(units), "cases" if len(units) > 1 else "case") as stage:

        def on_event(unit: AnyUnit, event: AnyEvent) -> None:
            if isinstance(event, Finished | Failed):
                stage.update(unit.name, 1.0)
            if isinstance(event, Failed) and not alone:
                stage.say(f"{unit.name}: {event.text}")
            if isinstance(event, Retried):
                stage.say(event.text)

        failures = run_units(units, workers, on_event, ONE_THREAD)
    order = [case.name for case in cases]
    return sorted(failures, key=lambda failure: order.index(failure.unit.name))


def folder_of(case: Case, out: Path, *, alone: bool) -> Path:
    """Where a case's files lie: in `out` itself if it is the only one."""
    return out if alone else out / case.name


def diagnose_into(
    path: Path,
    reading: Reading,
    nominal: str,
    folder: Path,
    *,
    pybullet: bool,
    against: Path | None,
) -> None:
    """Diagnose one case and put its files in place; those of an earlier diagnosis that it has not are removed.

    Raises:
        InputError: The case cannot be read, or holds nothing that can be diagnosed.
    """
    from diagnosis.diagnose import diagnose  # noqa: PLC0415 - scipy and matplotlib, in the worker alone
    from diagnosis.report.files import PLOTS, VARIED_FILE, files  # noqa: PLC0415 - as above

    robot = RobotConfig.model_validate_json(nominal) if nominal else None
    release = None if against is None else read_measurement(against, IMPORTERS)
    measured = reading.measurement(path)
    unseen = read_blind(path if path.is_dir() else path.parent, measured.kind) if measured.kind in BLIND else {}
    made = files(diagnose(measured, robot), pybullet=pybullet, release=release, unseen=unseen)
    make_folder(folder / PLOTS)
    for old in (folder / VARIED_FILE, folder / TRACEBACK, *(folder / PLOTS).iterdir()):
        if old.relative_to(folder).as_posix() not in made:
            remove_file(old)
    for name, data in made.items():
        write_file(folder / name, data)
