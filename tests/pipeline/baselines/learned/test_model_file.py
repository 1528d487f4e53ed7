"""A model file comes back unchanged, and whatever is no model is refused in one line."""

import io
from dataclasses import replace

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.baselines.learned.model import read_model
from symolo.arena.fingerprint import arena_fingerprint
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError

REMEDY = "symolo train DIR --out model.npz"


@pytest.fixture
def path(tmp_path, model):
    file = tmp_path / "model.npz"
    file.write_bytes(model.file_bytes())
    return file


def test_a_model_comes_back_from_its_file(model, path):
    read = read_model(path)
    assert read.about == model.about
    assert read.likelihood.grid == model.likelihood.grid
    assert np.array_equal(read.likelihood.cells, model.likelihood.cells)
    assert np.array_equal(read.likelihood.prior, model.likelihood.prior)
    assert read.weights.keys() == model.weights.keys()
    assert np.array_equal(read.weights["head.0.weight"], model.weights["head.0.weight"])
    assert read.file_bytes() == path.read_bytes()


def test_it_is_an_archive_that_numpy_reads_without_running_code(path):
    with np.load(path, allow_pickle=False) as archive:
        assert {archive[name].dtype.kind for name in archive} == {"u", "i", "f"}


def archive(**arrays):
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def changed(path, **arrays):
    with np.load(path, allow_pickle=False) as whole:
        return archive(**{name: whole[name] for name in whole} | arrays)


def text(about):
    return np.frombuffer(about.encode(), np.uint8)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (lambda path: path.read_bytes()[:-300], "or is damaged"),
        (lambda _: b"PK\x03\x04 and no more", "or is damaged"),
        (lambda _: b"", "or is damaged"),
        (lambda _: archive(t_s=np.arange(3.0)), "or is damaged"),
        (lambda path: changed(path, about=text('{"version": 1}')), "version: Input should be 2"),
        (lambda path: changed(path, about=text("[")), "Invalid JSON"),
        (lambda path: changed(path, cells=np.array([3, 2])), "cells that do not fit"),
        (lambda path: changed(path, cells=np.arange(616) + 1), "cells that do not fit"),
        (lambda path: changed(path, prior=np.full(616, 1.0)), "no distribution"),
        (lambda path: changed(path, **{"weight/head.0.weight": np.array([np.nan])}), "not finite"),
        (lambda path: changed(path, prior=np.array([print], dtype=object)), "or is damaged"),
    ],
)
def test_what_is_no_model_is_refused(path, data, message):
    path.write_bytes(data(path))
    with pytest.raises(InputError, match=message) as error:
        read_model(path)
    assert str(path) in str(error.value)
    assert REMEDY in str(error.value)


def test_a_missing_file_is_named_with_the_remedy(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.npz: cannot be read") as error:
        read_model(tmp_path / "nowhere.npz")
    assert REMEDY in str(error.value)


def test_an_arena_is_recognised_by_its_shapes_and_not_by_its_look():
    def arena(*settings):
        return Arena.from_config(draw_run(load_scenario("symolo", list(settings)), "CW", 1).arena)

    one, other = arena("seed=1"), arena("seed=2", "arena.floor.reflectance=0.5")
    assert one.floor_reflectance != other.floor_reflectance
    assert arena_fingerprint(one) == arena_fingerprint(other)
    moved = replace(one.boxes[0], center=(one.boxes[0].center[0] + 0.01, *one.boxes[0].center[1:]))
    wider = replace(one.line, width_m=one.line.width_m + 0.002)
    assert arena_fingerprint(replace(one, boxes=(moved, *one.boxes[1:]))) != arena_fingerprint(one)
    assert arena_fingerprint(replace(one, line=wider)) != arena_fingerprint(one)
