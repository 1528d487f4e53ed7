"""Imported runs into an output folder, as a dataset with checksums."""

from pathlib import Path

from pipeline.importing.imported_runs import ImportedDataset
from pipeline.run_folder.losses import check_losses, protected_runs
from pipeline.run_folder.output import check_out
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import assemble
from pipeline.stages.run_tables import write_external_run
from symolo.core.files.disk_space import check_disk
from symolo.core.progress import Report
from symolo.dataset.folder_kind import Kind

_COPIES = 2
"""The stages keep the tables of a dataset."""
_BYTES_PER_RUN = 100_000


def check_place(
    dataset: ImportedDataset, out: Path, report: Report, *, replace: bool = False, dry_run: bool = False
) -> None:
    """Refuse an output folder that cannot be used, before anything is written.

    Args:
        dataset: The runs.
        out: Their folder.
        report: Receiver of a line about a finished release that would lose something.
        replace: Whether a finished release in it may lose something.
        dry_run: Whether nothing will be written.

    Raises:
        InputError: It is not a place for an imported dataset.
        EnvironmentLacking: The disk is too full.
    """
    check_out(out, Kind.IMPORTED)
    workspace, specs = Workspace(out.absolute(), Kind.IMPORTED), [run.spec for run in dataset.runs]
    check_losses(workspace, dataset.tree, specs, report, replace=replace, dry_run=dry_run)
    tables = sum(len(run.rows.to_csv()) + sum(map(len, run.side.values())) for run in dataset.runs)
    check_disk(out, _COPIES * tables + _BYTES_PER_RUN * len(dataset.runs), "import fewer logs")


def write_dataset(dataset: ImportedDataset, out: Path, report: Report, *, replace: bool = False) -> None:
    """Write the runs into a checked folder; a run that is there unchanged stays."""
    workspace, specs = Workspace(out.absolute(), Kind.IMPORTED), [run.spec for run in dataset.runs]
    with workspace.locked():
        protected = protected_runs(workspace, dataset.tree, specs, report, replace=replace)
        with report.stage("import", len(dataset.runs), "runs") as stage:
            for number, run in enumerate(dataset.runs, 1):
                write_external_run(run, workspace.simulate(run.spec.key))
                stage.update("all", number)
        assemble(workspace, dataset.tree, specs, [], report, sensors=dataset.sensors, protected=protected)
