"""An export killed at random instants is whole or not there, and the same command again makes it whole."""

import shutil

import numpy as np
import pytest

FORMATS = "tum,kitti,webdataset"


@pytest.mark.parametrize("kills", [2, pytest.param(300, marks=pytest.mark.faults)])
def test_killed_at_random_instants_it_is_whole_or_not_there(kills, server, tree, tmp_path):
    instants = np.random.Generator(np.random.PCG64(11))
    assert server.release(tmp_path / "release").status == 0

    def export(name, **order):
        out = tmp_path / name
        arguments = ["export", str(tmp_path / "release"), "--format", FORMATS, "--out", str(out)]
        return server.release(out, arguments=arguments, **order)

    undisturbed = export("whole")
    assert undisturbed.status == 0, undisturbed.err
    expected = tree(tmp_path / "whole")
    killed = 0
    while killed < kills:
        done = export("out", kill_after_s=float(instants.uniform(0, undisturbed.seconds)))
        assert done.status in {0, -9}, done.err
        killed += done.status == -9
        assert tree(tmp_path / "out") in ({}, expected), f"kill {killed}"
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
    assert export("out").status == 0
    assert tree(tmp_path / "out") == expected
    assert {path.name for path in tmp_path.iterdir()} == {"release", "whole", "out"}
