"""Steady states of a motor on a bench: voltage, current and speed in sweeps (a measured case)."""

from diagnosis.importers.cases.case import case_importer
from diagnosis.importers.cases.motor_case import motor_noise, motor_notes
from diagnosis.measured.case_files.nominal import NominalSteady
from diagnosis.measured.measurement import CaseKind

IMPORTER = case_importer(CaseKind.MOTOR_STEADY, NominalSteady, motor_noise, motor_notes)
