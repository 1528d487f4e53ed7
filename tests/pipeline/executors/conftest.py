"""A cluster that is not there."""

import sys
from types import SimpleNamespace

import pytest


class PretendedRay:
    """Does every task when it is asked for, and notes what tasks ask for."""

    exceptions = SimpleNamespace(RayTaskError=LookupError, RayError=LookupError)

    def __init__(self, answer, resources):
        self.asked, self._answer, self._resources = [], answer, resources
        self.most = self._given = 0

    def init(self, **options):
        assert options["address"] == "auto"

    def shutdown(self):
        assert self._given == 0

    def cluster_resources(self):
        return self._resources

    def remote(self, **options):
        self.asked.append(options)
        return lambda _function: SimpleNamespace(remote=self._give)

    def _give(self, *_arguments):
        self._given += 1
        self.most = max(self.most, self._given)
        return object()

    def wait(self, references, num_returns):
        return references[:num_returns], references[num_returns:]

    def get(self, _reference):
        self._given -= 1
        return self._answer


@pytest.fixture
def pretended_ray(monkeypatch):
    """Makes one with these resources, whose tasks all end with `answer`, a record as JSON."""

    def make(answer="{}", **resources):
        ray = PretendedRay(answer, resources)
        monkeypatch.setitem(sys.modules, "ray", ray)
        return ray

    return make
