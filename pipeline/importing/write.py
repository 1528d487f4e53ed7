"""Imported runs into an output folder, as a dataset with checksums."""

from pathlib import Path

from pipeline.importing.imported_runs import ImportedDataset
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


def check_place(dataset: ImportedDataset, out: Path) -> None:
    """Refuse an output folder that cannot be used, before anything is written.

    Raises:
        InputError: It is not a place for an imported dataset.
        EnvironmentLacking: The disk is too full.
    """
    check_out(out, Kind.IMPORTED)
    tables = sum(len(run.rows.to_csv()) + sum(map(len, run.side.values())) for run in dataset.runs)
    check_disk(out, _COPIES * tables + _BYTES_PER_RUN * len(dataset.runs))


def write_dataset(dataset: ImportedDataset, out: Path, report: Report) -> None:
    """Write the runs into a checked folder; a run that is there unchanged stays."""
    workspace = Workspace(out.absolute(), Kind.IMPORTED)
    with workspace.locked():
        with report.stage("import", len(dataset.runs), "runs") as stage:
            for number, run in enumerate(dataset.runs, 1):
                write_external_run(run, workspace.simulate(run.spec.key))
                stage.update("all", number)
        specs = [run.spec for run in dataset.runs]
        assemble(workspace, dataset.tree, specs, [], report, sensors=dataset.sensors)
