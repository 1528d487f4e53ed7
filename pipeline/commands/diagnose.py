"""The command `symolo diagnose`: how the simulation differs from measured data, why, and what a better model gains."""

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Out, Workers, checked_input
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pipeline.diagnosing.diagnose import NamedCase
    from pipeline.work.units import DiagnosisSettings

CASE_FAILED = 3


def _checked(paths: Collection) -> list[Path]:  # bare, because Typer on Python 3.10 takes `list[Path]` for a class
    return [checked_input(path) for path in paths]


def _checked_one(path: Path | None) -> Path | None:
    return None if path is None else checked_input(path)


def diagnose(
    cases: Annotated[
        list[Path],
        typer.Argument(
            metavar="CASE...",
            callback=_checked,
            help="Measured data: case folders, logs, runs of a dataset, or table-1, table-3, table-4 of the paper.",
        ),
    ],
    *,
    out: Out,
    as_: Annotated[
        str | None,
        typer.Option(
            "--importer", metavar="NAME", help="Kind of data; by default symolo recognises it from the files."
        ),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Look at one part of the robot alone, such as 'left wheel'."),
    ] = None,
    hold_out: Annotated[
        list[str] | None,
        typer.Option(
            "--hold-out",
            metavar="PATTERN",
            help="Use trials with this name or part, such as 'circular/*', only to judge the result, in place of the "
            "default ones; may be repeated.",
        ),
    ] = None,
    nominal: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT", help="Nominal robot for what CASE does not state: a shipped one, or a YAML file."
        ),
    ] = None,
    pybullet: Annotated[
        bool,
        typer.Option(
            "--pybullet", help="Also measure the errors before and after with PyBullet; a drive takes minutes."
        ),
    ] = False,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="DATASET",
            callback=_checked_one,
            help="Report how far this dataset of symolo covers the measured drives; its robot is the nominal one.",
        ),
    ] = None,
    workers: Workers = None,
    explain: Annotated[bool, typer.Option("--explain", help="Also print how the verdict was reached.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answers as JSON and nothing else.")] = False,
) -> int:
    """Explain why the simulation differs from a real robot or test bench.

    The result names the effects that the real robot has and the simulated
    one lacks, with their parameters and how certain they are; effects that
    these data cannot distinguish; what stays unexplained; and how much
    better the extended robot predicts rows that were not used for fitting.
    `symolo inspect --help` lists the data that can be read;
    docs/diagnosis.md explains the result.

    Files in DIR, or in DIR/CASE for several cases:

    - report.html: one page with everything; begin there

    - answer.json: the result in the form of docs/diagnosis.md

    - extended.yaml: the extended robot, for --set robot=FILE, and
      extended_varied.yaml, which draws uncertain values for each run

    - summary.txt, reasoning.txt, plots/

    If some of several cases cannot be diagnosed, the command names them,
    finishes the others and ends with exit code 3.

    Example: symolo diagnose my_robot/bench_1 --out diagnosis

    Example: symolo diagnose my_robot/* --out diagnosis --workers 4

    Judge the result on the circular drives only: symolo diagnose my_set --hold-out 'circular/*' --out diagnosis
    """
    from pipeline.diagnosing.diagnose import cases_of, diagnose_cases, nominal_json
    from pipeline.run_folder.output import check_out
    from pipeline.run_folder.workspace import Workspace
    from pipeline.work.supervisor import cores
    from pipeline.work.units import DiagnosisSettings
    from symolo.core.progress import report_here
    from symolo.dataset.folder_kind import Kind

    if explain and as_json:
        raise InputError("--explain and --json", cure="give one of them; reasoning.txt is written in any case")
    named = cases_of(cases)
    if any(case.path.absolute() == out.absolute() for case in named):
        # As soon as a folder `table-1` exists, `table-1` means that folder.
        raise InputError("is the name of a case", where=f"--out {out}", cure="name another folder")
    settings = DiagnosisSettings(
        importer=as_,
        part=part,
        held_out=tuple(hold_out or ()),
        nominal=nominal_json(nominal, against),
        pybullet=pybullet,
        against=against,
    )
    check_out(out, Kind.DIAGNOSIS)
    if len(named) == 1:
        _check(named[0], settings)
    with Workspace(out.absolute(), Kind.DIAGNOSIS).locked():
        report = report_here()
        failures = diagnose_cases(named, settings, out=out.absolute(), workers=workers or cores(), report=report)
    failed = {failure.unit.name: failure.text for failure in failures}
    if as_json:
        _print_json(named, out, failed)
    else:
        _print(named, out, failed, explain=explain)
    return CASE_FAILED if failed else 0


def _check(case: "NamedCase", settings: "DiagnosisSettings") -> None:
    """Refuse the only case before anything is written."""
    from diagnosis.dataset_comparison import check_drive
    from diagnosis.diagnose import check_kind
    from pipeline.diagnosing.diagnose import read_case

    measurement = read_case(case.path, settings)
    check_kind(measurement)
    if settings.against is not None:
        check_drive(measurement, "CASE")


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
        typer.echo(f"{out / 'report.html'}, {out / 'answer.json'}, {out / 'extended.yaml'}")


def _print_json(cases: "Sequence[NamedCase]", out: Path, failed: "Collection[str]") -> None:
    import json

    from pipeline.diagnosing.diagnose import folder_of

    alone = len(cases) == 1
    answers = {
        case.name: json.loads(read_file(folder_of(case, out, alone=alone) / "answer.json", FileKind.DOCUMENT))
        for case in cases
        if case.name not in failed
    }
    typer.echo(json.dumps(next(iter(answers.values())) if alone and answers else answers, indent=2, ensure_ascii=False))
