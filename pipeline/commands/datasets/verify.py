"""`symolo verify`: checks a dataset, and renders images again to compare their bytes."""

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
)
from symolo.core.errors import InputError, one_line

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
        reproduced=ReproducedPart.from_reproduction(drawn.reproduction, drawn.seed) if drawn else None,
    )
    typer.echo(result.to_json())
