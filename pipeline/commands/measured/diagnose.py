"""`symolo diagnose`: explains the differences between measured data and the simulation."""

import json
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.exit_codes import RUN_FAILED
from pipeline.commands.options import (
    ImporterName,
    Json,
    Out,
    Workers,
    checked_input,
    checked_inputs,
    if_given,
    in_one_thread,
    load_effects,
)
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file

if TYPE_CHECKING:
    from pipeline.diagnosing.diagnose import NamedCase
    from pipeline.work.units import DiagnosisSettings
    from symolo.core.progress import Report


def diagnose(
    cases: Annotated[
        list[Path],
        typer.Argument(
            metavar="CASE...",
            # The check of --out loads NumPy, whose threads must be limited before.
            is_eager=True,
            callback=in_one_thread(checked_inputs),
            help="Measured data: case folders, logs, runs of a dataset, or table-1, table-3, table-4 of the paper.",
        ),
    ],
    *,
    out: Out,
    importer: ImporterName = None,
    part: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Diagnose only this part of the robot, such as 'left wheel'."),
    ] = None,
    hold_out: Annotated[
        list[str] | None,
        typer.Option(
            "--hold-out",
            metavar="PATTERN",
            help="Hold out the trials whose name or part matches, such as 'circular/*', instead of the default ones. "
            "Trials that are held out are used to judge the result and to decide which effects are named; "
            "no number is fitted to them. May be repeated.",
        ),
    ] = None,
    nominal: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT",
            help="Robot for all parameters that CASE does not state: name of a shipped one, or a YAML file.",
        ),
    ] = None,
    pybullet: Annotated[
        bool,
        typer.Option(
            "--pybullet", help="Also measure the errors of both robots with PyBullet, which takes minutes for a drive."
        ),
    ] = False,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="DATASET",
            callback=if_given(checked_input),
            help="Report whether this dataset of symolo covers the measured drives, and use its robot as "
            "the nominal one.",
        ),
    ] = None,
    effects: Annotated[
        list[Path] | None,
        typer.Option(
            "--effects",
            metavar="FILE",
            help="Also try the effect of your own in this Python file, which is executed; may be repeated.",
        ),
    ] = None,
    together: Annotated[
        bool,
        typer.Option("--together", help="All cases are of one robot: fit them together, for one result in DIR."),
    ] = False,
    discover: Annotated[
        bool,
        typer.Option(
            "--discover",
            help="Where something stays unexplained in a case, look for a law that describes it, and "
            "write it as an effect file.",
        ),
    ] = False,
    workers: Workers = None,
    explain: Annotated[bool, typer.Option("--explain", help="Also print how the result was reached.")] = False,
    as_json: Json = False,
) -> int:
    """Explain why the simulation differs from a real robot or test bench.

    The result has four parts:

    - the effects that the real robot has and the simulated one lacks, with
      their parameters and confidence

    - effects that these data cannot distinguish

    - deviations that stay unexplained

    - how much better the extended robot, which has these effects, predicts
      rows that were not used to fit the numbers; they helped to decide which
      effects are named

    `symolo inspect --help` lists the data that can be read.
    docs/diagnosis.md and docs/diagnosis_report.md explain the result.

    The command writes these files into DIR, or into DIR/CASE for several
    cases:

    - report.html: one page with all results; begin with this file

    - answer.json: the result for programs (docs/diagnosis_report.md)

    - extended.yaml: the extended robot, for --set robot=FILE

    - posterior.yaml: the robots that agree with the data, for
      release --like DIR

    - the file of each effect of your own that the extended robot has, and of
      the law that --discover proposes

    - made_from.json: the cases and options, for `symolo next`

    - summary.txt, reasoning.txt, plots/: the printed text, and the plots of
      the page

    If one of several cases cannot be diagnosed, the command names it,
    finishes the others and ends with exit code 3.

    Example: symolo diagnose my_robot/bench_1 --out diagnosis

    Example: symolo diagnose my_robot/* --out diagnosis --workers 4

    Several cases of one robot: symolo diagnose my_robot/* --together --out diagnosis

    Try an effect of your own as well: symolo diagnose my_robot/drive_1 --effects oval_wheel.py --out diagnosis

    Describe what no listed effect explains: symolo diagnose my_robot/bench_1 --discover --out diagnosis

    Judge the result on the circular drives only: symolo diagnose my_set --hold-out 'circular/*' --out diagnosis
    """
    from pipeline.diagnosing.diagnose import cases_of, diagnose_cases, nominal_json
    from pipeline.run_folder.output import check_out
    from pipeline.run_folder.workspace import Workspace
    from pipeline.work.supervisor import cores
    from pipeline.work.units import DiagnosisSettings
    from pipeline.work.worker_main import diagnose_case
    from symolo.core.progress import report_here
    from symolo.dataset.folder_kind import Kind

    load_effects(effects or ())
    if explain and as_json:
        raise InputError("--explain and --json", cure="give one of them; reasoning.txt is written in any case")
    named = cases_of(cases)
    if any(case.path.absolute() == out.absolute() for case in named):
        # As soon as a folder `table-1` exists, `table-1` means that folder.
        raise InputError("is the name of a case", where=f"--out {out}", cure="name another folder")
    if together:
        _check_together(cases, discover=discover, against=against)
        named = named[:1]
    settings = DiagnosisSettings(
        importer=importer,
        part=part,
        held_out=tuple(hold_out or ()),
        nominal=nominal_json(nominal, against),
        pybullet=pybullet,
        against=against,
        together=tuple(cases[1:]) if together else (),
        discover=discover,
    )
    check_out(out, Kind.DIAGNOSIS)
    report = report_here()
    if len(named) == 1:
        _check(named[0], settings, report)
    with Workspace(out.absolute(), Kind.DIAGNOSIS).locked():
        failures = diagnose_cases(
            named, settings, out=out.absolute(), workers=workers or cores(), report=report, do_here=diagnose_case
        )
    failed = {failure.unit.name: failure.text for failure in failures}
    if as_json:
        _print_json(named, out, failed)
    else:
        _print(named, out, failed, explain=explain)
    return RUN_FAILED if failed else 0


def _check(case: "NamedCase", settings: "DiagnosisSettings", report: "Report") -> None:
    """Refuse the only case before anything is written, and report if it may take long."""
    from diagnosis.measured.predicted_kinds import check_kind
    from pipeline.diagnosing.diagnose import read_case
    from pipeline.diagnosing.long_drives import long_drive_note

    measurement = read_case(case.path, settings)
    check_kind(measurement)
    if note := long_drive_note(case.path, measurement):
        report.say(f"note: {note}")
    if settings.against is not None:
        from diagnosis.dataset_comparison import check_drive

        check_drive(measurement, "CASE")


def _check_together(cases: "Sequence[Path]", *, discover: bool, against: Path | None) -> None:
    """Refuse options that need a single case, and a single case."""
    if len(cases) < 2:
        raise InputError("--together with one case", cure="name two or more cases of the same robot")
    if discover:
        raise InputError("--together and --discover", cure="look for a law in one bench alone")
    if against is not None:
        raise InputError("--together and --against", cure="compare one drive with the dataset")


def _print(cases: "Sequence[NamedCase]", out: Path, failed: "Collection[str]", *, explain: bool) -> None:
    from pipeline.diagnosing.diagnose import folder_of
    from pipeline.diagnosing.table import diagnosis_table

    alone = len(cases) == 1
    finished = [(case.name, folder_of(case, out, alone=alone)) for case in cases if case.name not in failed]
    for name, folder in finished if alone or explain else ():
        if not alone:
            typer.echo(f"== {name}\n")
        typer.echo(read_file(folder / "summary.txt", FileKind.DOCUMENT).decode("utf-8"))
        if explain:
            typer.echo(read_file(folder / "reasoning.txt", FileKind.DOCUMENT).decode("utf-8"))
    if not alone:
        for line in diagnosis_table(cases, out, failed):
            typer.echo(line)
    elif finished:
        typer.echo(
            ", ".join(str(out / name) for name in ("report.html", "answer.json", "extended.yaml", "posterior.yaml"))
        )


def _print_json(cases: "Sequence[NamedCase]", out: Path, failed: "Collection[str]") -> None:
    from pipeline.diagnosing.diagnose import folder_of

    alone = len(cases) == 1
    answers = {
        case.name: json.loads(read_file(folder_of(case, out, alone=alone) / "answer.json", FileKind.DOCUMENT))
        for case in cases
        if case.name not in failed
    }
    typer.echo(json.dumps(next(iter(answers.values())) if alone and answers else answers, indent=2, ensure_ascii=False))
