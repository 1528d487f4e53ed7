"""Three benches, diagnosed once: one with a weak magnet, one without any effect, one with a bump that has no name."""

import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.report.files import files
from diagnosis.report.report_data import report_data

BENCHES = {"weak": {"strength": 0.9}, "plain": {}, "bumped": {"bump_A": 0.02, "sweeps": 4}}


@pytest.fixture(scope="session")
def diagnosis_of(motor_bench_case, tmp_path_factory):
    made = {}

    def of(name):
        if name not in made:
            folder = motor_bench_case(tmp_path_factory.mktemp("benches") / name, **BENCHES[name])
            made[name] = diagnose(read_measurement(folder, IMPORTERS))
        return made[name]

    return of


@pytest.fixture(scope="session")
def findings_of(diagnosis_of):
    made = {}

    def of(name):
        if name not in made:
            made[name] = report_data(diagnosis_of(name))
        return made[name]

    return of


@pytest.fixture(scope="session")
def files_of(diagnosis_of):
    made = {}

    def of(name):
        if name not in made:
            made[name] = files(diagnosis_of(name))
        return made[name]

    return of
