"""Cases of measured data diagnosed side by side, each into a folder of its own, whatever the number of workers."""

import json
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from configs.draw import draw_robot
from configs.effects.registry import EFFECTS
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.case_format import BLIND, DATA
from diagnosis.measured.case_files.nominal import NOMINAL
from diagnosis.measured.holdout import hold_out, select_part
from diagnosis.measured.measurement import Measurement
from diagnosis.progress import DiagnosisProgress, Phase, unreported
from pipeline import user_code
from pipeline.diagnosing.importers import IMPORTERS
from pipeline.diagnosing.importers.run_folder import robots_of
from pipeline.diagnosing.made_from import MADE_FROM, MadeFrom
from pipeline.work.processors import ONE_THREAD, use_one_thread
from pipeline.work.supervisor import AnyEvent, AnyUnit, Retried, UnitFailure, run_units
from pipeline.work.units import DiagnoseUnit, DiagnosisSettings, Progress
from symolo.core.child_process import Failed, Finished
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, remove_file, write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import SECONDS_BETWEEN_LINES, Report, StageReport, time_left
from symolo.dataset.layout import STAGES

if TYPE_CHECKING:
    from diagnosis.diagnose import Diagnosis

TRACEBACK = "traceback.txt"
"""Name of the file in the folder of a case whose diagnosis met a bug."""


@dataclass(frozen=True)
class NamedCase:
    """A case to diagnose."""

    path: Path
    name: str
    """Name of its folder in the output."""


def cases_of(paths: Sequence[Path]) -> list[NamedCase]:
    """Return the cases with their names; runs of one number also have the names of their routes, such as CW-test_1.

    Raises:
        InputError: Two of them would go into one folder.
    """
    counts = Counter(_name(path).lower() for path in paths)
    cases: dict[str, NamedCase] = {}
    for path in paths:
        name = _name(path)
        case = NamedCase(path, name if counts[name.lower()] == 1 else f"{_folder(path).parent.name}-{name}")
        other = cases.setdefault(case.name.lower(), case)
        if other is not case:
            cure = "diagnose them into two folders"
            raise InputError(f"another case has the name {name}: {other.path}", where=str(path), cure=cure)
    return list(cases.values())


def _folder(path: Path) -> Path:
    """Return the folder of a case, or the file if that has a name of its own."""
    whole = path.absolute()
    return whole.parent if whole.name in {DATA, NOMINAL} else whole


def _name(path: Path) -> str:
    folder = _folder(path)
    name = folder.stem if folder.is_file() else folder.name
    return f"{name}_" if name in {"", STAGES} else name


def nominal_json(name: str | None, against: Path | None = None) -> str:
    """Return the nominal robot as JSON text: that of the name or file, else the one robot of a dataset; empty for none.

    Raises:
        InputError: There is no such robot, or it is no single one; there is no such dataset.
    """
    if name is None and against is not None and len(robots := robots_of(against)) == 1:
        return robots[0].model_dump_json()
    if name is None:
        return ""
    section = load_section("robot", name, option="--nominal")
    if section.distributions:
        field = ".".join(map(str, next(iter(section.distributions))))
        cure = "write a number in its place"
        raise InputError(f"{field}: a nominal robot has no distributions", where=f"--nominal {name}", cure=cure)
    robot, _ = draw_robot(section, 0, "diagnosis")
    return robot.model_dump_json()


def read_case(path: Path, settings: DiagnosisSettings) -> Measurement:
    """Return the measured data of a case, with the part and the held-out trials that the settings name.

    Raises:
        InputError: The case cannot be read, or has no such part or trials; or the cases to fit together cannot be.
    """
    if settings.together:
        from diagnosis.together import together  # noqa: PLC0415 - loads the stages, which the command need not

        alone = settings.model_copy(update={"together": ()})
        return together([read_case(each, alone) for each in (path, *settings.together)])
    measurement = read_measurement(path, IMPORTERS, settings.importer)
    if settings.part is not None:
        measurement = select_part(measurement, settings.part)
    return hold_out(measurement, settings.held_out) if settings.held_out else measurement


def robot_of(settings: DiagnosisSettings) -> RobotConfig | None:
    """Return the nominal robot of the settings; None for the one that the case itself describes."""
    return RobotConfig.model_validate_json(settings.nominal) if settings.nominal else None


def diagnose_cases(
    cases: Sequence[NamedCase],
    settings: DiagnosisSettings,
    *,
    out: Path,
    workers: int,
    report: Report,
    do_here: Callable[[DiagnoseUnit, Callable[..., None]], None],
) -> list[UnitFailure]:
    """Diagnose all cases and return those that failed, in their order.

    Args:
        cases: The cases.
        settings: How they are diagnosed.
        out: Folder of the files.
        workers: Number of worker processes at a time.
        report: Receives the progress.
        do_here: Function that diagnoses the only case in this process, as the start of a worker takes longer than the
            fits of a bench; it is called with the unit and a receiver of its progress.

    Raises:
        InputError: The only case is bad.
    """
    alone = len(cases) == 1
    units = [
        DiagnoseUnit(
            name=case.name,
            case=case.path,
            settings=settings,
            folder=folder_of(case, out, alone=alone),
            alone=alone,
        )
        for case in cases
    ]
    # How many hypotheses are fitted depends on what the fits show, so the share of a case says little about its rest.
    with report.stage("diagnose", len(units), "cases", is_even=False) as stage:
        phase_lines = PhaseLines(stage, estimates=not settings.discover)

        def on_event(unit: AnyUnit, event: AnyEvent) -> None:
            if isinstance(event, Progress):
                stage.update(unit.name, event.share)
                if alone:
                    phase_lines.print(event)
            if isinstance(event, Finished | Failed):
                stage.update(unit.name, 1.0)
            if isinstance(event, Failed) and not alone:
                stage.say(f"{unit.name}: {event.text}")
            if isinstance(event, Retried):
                stage.say(event.text)

        # Code of the user may end its process, and PyBullet prints.
        if alone and not settings.pybullet and not user_code.environment() and use_one_thread():
            unit = units[0]
            do_here(unit, lambda share, at=None, text="": on_event(unit, Progress(share=share, at=at, text=text)))
            on_event(unit, Finished())
            return []
        failures = run_units(units, workers, on_event, ONE_THREAD)
    order = [case.name for case in cases]
    return sorted(failures, key=lambda failure: order.index(failure.unit.name))


class PhaseLines:
    """Prints each phase of the only case when it begins, and now and then what is fitted in it.

    From the second phase on, the time left is estimated from the share of the time that the phases before it usually
    take, if they took long. A search for a law takes an unknown time; with one, `estimates` is False.
    """

    def __init__(self, stage: StageReport, *, estimates: bool) -> None:
        self._stage, self._estimates = stage, estimates
        self._begun: set[Phase] = set()
        self._started_s = self._printed_s = time.monotonic()

    def print(self, event: Progress) -> None:
        phase, now_s = Phase.at(event.share), time.monotonic()
        if phase not in self._begun:
            self._begun.add(phase)
            self._stage.say(f"{phase.title}{self._left(phase, now_s - self._started_s)}")
        elif event.text and now_s - self._printed_s >= SECONDS_BETWEEN_LINES:
            self._stage.say(f"{phase.title}: {event.text}")
        else:
            return
        self._printed_s = now_s

    def _left(self, phase: Phase, passed_s: float) -> str:
        """Return the time left when a phase begins, as the end of a line; empty if nothing is known about it."""
        if not self._estimates or passed_s < SECONDS_BETWEEN_LINES or not phase.value:
            return ""
        return f"; about {time_left(passed_s, phase.value / 100)} left"


def diagnosed_again(measurement: Measurement, settings: DiagnosisSettings, report: Report) -> "Diagnosis":
    """Return the diagnosis of a measurement in this process, as its files do not hold all of it."""
    from diagnosis.diagnose import diagnose  # noqa: PLC0415 - loads SciPy, which the command need not

    report.say(f"{measurement.name} is diagnosed again, which takes about as long as before")
    with report.stage("diagnose", 100, "%") as stage:
        diagnosis = diagnose(
            measurement,
            robot_of(settings),
            DiagnosisProgress(lambda share: stage.update(measurement.name, 100 * share)),
        )
        stage.update(measurement.name, 100)
    return diagnosis


def folder_of(case: NamedCase, out: Path, *, alone: bool) -> Path:
    """Return the folder for a case's files: `out` itself if it is the only case."""
    return out if alone else out / case.name


def diagnose_into(
    path: Path, settings: DiagnosisSettings, folder: Path, progress: DiagnosisProgress | None = None
) -> None:
    """Diagnose one case, write its files into `folder` and remove those of an earlier diagnosis.

    Args:
        path: The case.
        settings: How it is diagnosed.
        folder: Folder of the files.
        progress: Receives how far the diagnosis is, which is an estimate; by default nobody does.

    Raises:
        InputError: The case cannot be read, or holds nothing that can be diagnosed.
    """
    from diagnosis.diagnose import diagnose  # noqa: PLC0415 - loads SciPy and Matplotlib, which the command need not
    from diagnosis.report.files import PLOTS, files  # noqa: PLC0415 - as above

    robot = robot_of(settings)
    release = None if settings.against is None else read_measurement(settings.against, IMPORTERS)
    measurement = read_case(path, settings)
    is_blind = measurement.kind in BLIND
    unseen = read_blind(path if path.is_dir() else path.parent, measurement.kind) if is_blind else {}
    progress = progress or unreported()
    diagnosis = diagnose(measurement, robot, progress)
    if settings.discover:
        from diagnosis.discovery.discover import with_law  # noqa: PLC0415 - as above

        diagnosis = with_law(diagnosis)
    contents = files(diagnosis, pybullet=settings.pybullet, release=release, unseen=unseen, progress=progress)
    old_law = list(_law_file(folder))
    made_from = MadeFrom.from_case(path, settings).model_dump_json(indent=2, exclude_defaults=True) + "\n"
    contents = {**contents, MADE_FROM: made_from.encode()}
    make_folder(folder / PLOTS)
    for old in (folder / TRACEBACK, *old_law, *(folder / PLOTS).iterdir()):
        if old.relative_to(folder).as_posix() not in contents:
            remove_file(old)
    for name, data in contents.items():
        write_file(folder / name, data)


def _law_file(folder: Path) -> Iterator[Path]:
    """Yield the file of the law that an earlier diagnosis into a folder found, unless it is an effect of this one."""
    path = folder / "answer.json"
    if not path.exists():
        return
    try:
        answer = json.loads(read_file(path, FileKind.DOCUMENT))
        file = folder / Path(answer["discovery"]["file"]).name
    except (InputError, ValueError, KeyError, TypeError):
        return  # no answer of a diagnosis, or one without a law
    loaded = {effect.path.resolve() for effect in EFFECTS.files.values()}
    if file.suffix == ".py" and file.exists() and file.resolve() not in loaded:
        yield file
