"""What `train` and `baselines --model` refuse before any work, with and without PyTorch."""

import pytest

from pipeline.baselines.learned.training_runs import validation_runs


@pytest.fixture
def without_pytorch(monkeypatch):
    def missing(module):
        raise ModuleNotFoundError(module, name=module)

    monkeypatch.setattr("symolo.core.extras.import_module", missing)


@pytest.fixture
def model_path(tmp_path, model):
    path = tmp_path / "model.npz"
    path.write_bytes(model.file_bytes())
    return path


@pytest.mark.usefixtures("without_pytorch")
def test_without_pytorch_training_names_the_extra(symolo, dataset, tmp_path):
    ended = symolo("train", dataset, "--out", tmp_path / "model.npz")
    assert ended.code == 5
    assert "the package torch is missing" in ended.err
    assert "symolo[learn]" in ended.err
    assert not (tmp_path / "model.npz").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--inputs", "images,radar"], "allowed: images, ranges"),
        (["--runs", "CW/*"], "one run only"),
        (["--runs", "CW/test_9"], "CW/test_1"),
        (["--epochs", "0"], "epochs"),
        (["--out", "model.pt"], ".npz"),
    ],
)
def test_training_on_the_wrong_input_is_refused(symolo, dataset, tmp_path, arguments, message):
    ended = symolo("train", dataset, "--out", tmp_path / "model.npz", *arguments)
    assert ended.code == 2
    assert message in ended.err
    assert not (tmp_path / "model.npz").exists()


def test_the_method_is_left_out_without_a_model_and_refused_by_name(symolo, dataset, tmp_path):
    ended = symolo("baselines", dataset, "--out", tmp_path / "out", "--methods", "odometry,learned")
    assert ended.code == 2
    assert "train one with `symolo train`, and name it with --model" in ended.err
    ended = symolo("baselines", dataset, "--out", tmp_path / "all", "--methods", "odometry", "--model", "model.npz")
    assert ended.code == 2


def test_a_model_of_another_arena_is_refused(symolo, dataset, tmp_path, model_path):
    out = tmp_path / "out"
    ended = symolo("baselines", dataset, "--out", out, "--methods", "odometry,learned", "--model", model_path)
    assert ended.code == 2
    assert "it was trained in another arena" in ended.err
    assert "CW/test_1" in ended.err
    assert not out.exists()


def test_a_model_without_its_method_is_refused(symolo, dataset, tmp_path, model_path):
    ended = symolo("baselines", dataset, "--out", tmp_path / "o", "--methods", "odometry", "--model", model_path)
    assert ended.code == 2
    assert "not in --methods" in ended.err


@pytest.mark.parametrize(("count", "aside"), [(2, 1), (5, 1), (10, 2), (60, 12)])
def test_a_fifth_of_the_runs_is_set_aside(count, aside):
    runs = validation_runs(count, 3)
    assert len(runs) == aside
    assert runs <= set(range(count))
    assert runs == validation_runs(count, 3)
