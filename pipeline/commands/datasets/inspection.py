"""Commands that inspect data or the machine: verify, compare, schema, doctor."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.exit_codes import FAULTS, MACHINE_LACKS
from pipeline.commands.options import (
    Dataset,
    Json,
    Workers,
    checked_input,
    if_given,
    new_file_check,
)
from symolo.core.errors import InputError, one_line
from symolo.core.text_enum import TextEnum

if TYPE_CHECKING:
    from pipeline.repair.reproduction import Reproduction
    from symolo.verification.findings import Finding


def verify(
    folder: Dataset,
    *,
    key: Annotated[
        str | None,
        typer.Option(
            metavar="KEY",
            help="Public key of minisign: a file, or the 56 characters of the key. The dataset must be signed with the "
            "matching secret key.",
        ),
    ] = None,
    reproduce: Annotated[
        int | None,
        typer.Option(
            "--reproduce",
            min=1,
            max=100_000,
            metavar="K",
            help="Render K randomly chosen images again, and compare their bytes.",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0, max=2**32 - 1, metavar="N", help="Seed of this random choice; by default a different one each time."
        ),
    ] = None,
    workers: Workers = None,
    as_json: Json = False,
) -> int:
    """Check a dataset: structure, columns, units and ranges, rates, images, positions, checksums, signature.

    The command prints one line for each fault, and ends with exit code 4 if there is any. If another command is
    changing the dataset, it ends with exit code 2. With --reproduce, it ends with exit code 5 if an image cannot be
    rendered here, or if its bytes differ and the dataset was made on a different kind of machine or with different
    versions.

    Example: symolo verify data

    Example: symolo verify data --key symolo.pub --reproduce 10
    """
    from pipeline.code_files import code_file_lines
    from pipeline.run_folder.output import check_finished
    from pipeline.run_folder.stored_spec import spec_problem
    from symolo.core.files.file_locks import is_locked
    from symolo.core.progress import plural
    from symolo.dataset.layout import STAGES
    from symolo.signing.key_files import read_public_key
    from symolo.verification.signature import trusted_comment
    from symolo.verification.verify import verify as findings_of

    public, findings = read_public_key(key) if key is not None else None, []
    if is_locked(folder / STAGES):
        what, cure = "another symolo command is working in this folder", "verify it when that command has ended"
        raise InputError(what, where=str(folder), cure=cure)
    check_finished(folder)
    for finding in findings_of(folder, spec_problem, public):
        if not as_json:
            typer.echo(str(finding))
        findings.append(finding)
    if not as_json:
        for line in code_file_lines(folder):
            typer.echo(line)
    comment = trusted_comment(folder) if public is not None and not findings else ""
    if not as_json and findings:
        typer.echo(f"{folder}: {plural(len(findings), 'fault')}", err=True)
    elif not as_json:
        signed = f", signed by the key {public.name} ({comment})" if public is not None else ""
        typer.echo(f"{folder}: no fault{one_line(signed)}")
    drawn = None if findings or reproduce is None else _reproduced(folder, reproduce, seed, workers)
    code = FAULTS if findings else 0 if drawn is None else drawn.exit_code
    if as_json:
        _print_verify_result(folder, code, findings, (public.name, comment) if public else None, drawn)
    elif drawn is not None:
        _print_reproduction(folder, drawn)
    return code


@dataclass(frozen=True)
class _Drawn:
    """Images that were drawn at random and rendered again."""

    seed: int
    reproduction: "Reproduction"

    @property
    def exit_code(self) -> int:
        unequal = self.reproduction.unequal
        if not unequal:
            return 0
        is_machine = self.reproduction.difference or all(image.is_missing for image in unequal)
        return MACHINE_LACKS if is_machine else FAULTS


def _reproduced(folder: Path, count: int, seed: int | None, workers: int | None) -> _Drawn:
    import secrets

    from pipeline.repair.reproduction import reproduce
    from pipeline.work.supervisor import cores
    from symolo.core.progress import report_here
    from symolo.publishing.bagging import dataset_in

    chosen = secrets.randbelow(2**32) if seed is None else seed
    return _Drawn(chosen, reproduce(dataset_in(folder), count, chosen, workers or cores(), report_here()))


def _print_reproduction(folder: Path, drawn: _Drawn) -> None:
    result = drawn.reproduction
    for image in result.unequal:
        typer.echo(str(image))
    equal, total = len(result.images) - len(result.unequal), len(result.images)
    typer.echo(
        f"{folder}: {equal} of {total} images have the same bytes when they are rendered again (--seed {drawn.seed})"
    )
    if result.unequal and result.difference:
        typer.echo(f"{folder}: different bytes are no proof of a fault here: {result.difference}", err=True)


def _print_verify_result(
    folder: Path, code: int, findings: "Sequence[Finding]", signer: tuple[str, str] | None, drawn: _Drawn | None
) -> None:
    """Print the result of `verify` as JSON; `signer` has the name of the key and the comment of the signature."""
    from pipeline.json_results.verify import ReproducedPart, SignaturePart, VerifyResult, faults_of

    result = VerifyResult(
        exit_code=code,
        folder=str(folder),
        faults=faults_of(findings),
        signature=SignaturePart(key=signer[0], comment=signer[1]) if signer and not findings else None,
        reproduced=ReproducedPart.of(drawn.reproduction, drawn.seed) if drawn else None,
    )
    typer.echo(result.to_json())


def compare(
    a: Annotated[
        Path, typer.Argument(metavar="A", callback=checked_input, help="Dataset, run, folder of images, or a file.")
    ],
    b: Annotated[
        Path,
        typer.Argument(metavar="B", callback=checked_input, help="The same kind of data, to be compared with A."),
    ],
    tolerance_db: Annotated[
        float,
        typer.Option(
            "--tolerance-db",
            min=0,
            max=1000,
            metavar="DB",
            help="Smallest peak signal-to-noise ratio of files that count as equal; the peak of a column of numbers is "
            "its largest value.",
        ),
    ] = 50.0,
    *,
    every: Annotated[bool, typer.Option("--all", help="Also list identical files.")] = False,
    page: Annotated[
        Path | None,
        typer.Option(
            "--page",
            metavar="FILE",
            callback=if_given(new_file_check(".html", option="--page")),
            help="Also write a page with the images that differ beside each other, .html.",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Compare two datasets, runs or folders of images, file by file.

    The command prints a line for each file whose bytes differ, for each program and processor that differs, and for
    each setting of two releases that differs, and a line with the conclusion. The exit code is 0 if all files are
    identical, 6 if they are equal within --tolerance-db, and 7 if they differ.

    Example: symolo compare data data-of-another-machine --tolerance-db 60

    Example: symolo compare before after --page differences.html
    """
    from symolo.compare.comparison import Comparison
    from symolo.compare.conclusion import Conclusion, made_differently
    from symolo.compare.folders import Verdict
    from symolo.compare.folders import compare as results_of
    from symolo.compare.settings import changed_settings

    results = []
    for result in results_of(a, b, tolerance_db):
        results.append(result)
        if not as_json and (every or result.verdict is not Verdict.IDENTICAL):
            typer.echo(str(result))
    comparison = Comparison(a, b, tolerance_db, results, list(made_differently(a, b)), changed_settings(a, b))
    if page is not None:
        from symolo.compare.page import comparison_page
        from symolo.core.files.atomic_files import write_file

        write_file(page, comparison_page(comparison))
    if as_json:
        from pipeline.json_results.compare import CompareResult

        compared = CompareResult.of(comparison, every=every)
        typer.echo(compared.to_json())
        return compared.exit_code
    conclusion = Conclusion.of(results)
    typer.echo("\n".join((*comparison.other_lines, conclusion.text)))
    return conclusion.code


class SchemaOf(TextEnum):
    """The kinds of JSON and YAML that have a schema."""

    SCENARIO = "scenario"
    METADATA = "metadata"
    STATUS = "status"
    VERIFY = "verify"
    COMPARE = "compare"
    PLAN = "plan"
    RELEASE = "release"
    BASELINES = "baselines"
    EXPORT = "export"
    DOCTOR = "doctor"
    INSPECT = "inspect"


def schema(
    of: Annotated[
        SchemaOf,
        typer.Option(
            "--of",
            help="scenario: scenario files; metadata: metadata.json of a dataset; the others: what the command of "
            "this name prints with --json.",
        ),
    ] = SchemaOf.SCENARIO,
) -> None:
    """Print a JSON Schema: of scenario files, of metadata.json, or of the results that commands print with --json.

    Editors use the first two to check and complete such files.

    Example: symolo schema > scenario.schema.json

    Example: symolo schema --of verify > verify.schema.json
    """
    import json

    from configs.validation.json_schema import scenario_json_schema
    from pipeline.json_results import result_json_schema
    from symolo.dataset.documents.metadata_schema import metadata_json_schema

    match of:
        case SchemaOf.SCENARIO:
            document = scenario_json_schema()
        case SchemaOf.METADATA:
            document = metadata_json_schema()
        case _:
            document = result_json_schema(of.value)
    typer.echo(json.dumps(document, indent=2, ensure_ascii=False))


def doctor(*, as_json: Json = False) -> int:
    """Check this machine: Python, packages, system libraries, Blender, PyBullet, disk, cores, memory, graphics card.

    For each missing item, the command prints the line that installs it. If anything is missing, it ends with exit code
    5.

    Example: symolo doctor
    """
    from pipeline.doctor import examine

    checks = []
    for check in examine(Path.cwd()):
        if not as_json:
            typer.echo(str(check))
        checks.append(check)
    code = 0 if all(check.ok for check in checks) else MACHINE_LACKS
    if as_json:
        from pipeline.json_results.doctor import CheckPart, DoctorResult

        typer.echo(DoctorResult(exit_code=code, checks=[CheckPart.of(check) for check in checks]).to_json())
    return code
