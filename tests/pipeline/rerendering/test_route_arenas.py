"""Runs of routes with arenas of their own under another look."""

import pytest

from pipeline.cli import main
from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import RerenderRequest, prepare
from pipeline.rerendering.sources import read_sources

SETTINGS = ("rates.camera_hz=0", "stop.time_limit_s=0.2", "routes.CCW.arena=moving")


@pytest.fixture(scope="module")
def two_arenas(tmp_path_factory, in_this_process):
    out = tmp_path_factory.mktemp("two") / "data"
    with in_this_process():
        assert main(["release", "smoke", "--out", str(out), *(f"--set={each}" for each in SETTINGS)]) == 0
    return out


def scenario(path, request):
    return prepare(read_sources((path,), None, ImportRequest((path,))), request).tree


def test_a_number_of_the_arena_changes_in_all_of_them(two_arenas):
    request = RerenderRequest(("lab",), overrides=("arena.line.width_m=0.03",), camera_hz=1.0)
    tree = scenario(two_arenas, request)
    cw, ccw = tree["routes"]
    assert "arena" not in cw
    assert (ccw["arena"]["name"], ccw["arena"]["line"]["width_m"]) == ("moving", 0.03)
    assert (tree["arena"]["name"], tree["arena"]["line"]["width_m"]) == ("symolo", 0.03)


def test_another_arena_takes_the_place_of_all(two_arenas):
    tree = scenario(two_arenas, RerenderRequest(("lab",), arena="wall_gaps", camera_hz=1.0))
    assert all("arena" not in route for route in tree["routes"])
    assert tree["arena"]["name"] == "wall_gaps"
