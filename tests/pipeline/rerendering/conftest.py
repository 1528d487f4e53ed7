"""What the tests of `rerender` share."""

import pytest

from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import prepare
from pipeline.rerendering.sources import read_sources


@pytest.fixture(scope="session")
def prepared():
    """Return the runs that `rerender` would render of a path for a request."""

    def runs_of(path, request, runs=None):
        reading = ImportRequest((path,), arena=request.arena, robot=request.robot)
        return prepare(read_sources((path,), runs, reading), request).runs

    return runs_of
