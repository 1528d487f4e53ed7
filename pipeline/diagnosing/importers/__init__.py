"""All importers of measured data: those of `diagnosis`, and those of our own datasets, whose format is known here."""

from diagnosis.importers import IMPORTERS as MEASURED
from diagnosis.importers.base import Importer
from pipeline.diagnosing.importers import data_csv, run_folder

IMPORTERS: tuple[Importer, ...] = (*MEASURED, run_folder.IMPORTER, data_csv.IMPORTER)
"""In the order in which they are asked; a data.csv with nothing beside it comes after a run folder."""
