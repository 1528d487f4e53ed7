"""What lies within a dataset or a bag is its own: no command makes anything else there."""

import shutil

import pytest

MAKING = {
    "release": ("release", "smoke"),
    "simulate": ("simulate", "smoke"),
    "hil": ("hil", "smoke", "--simulated"),
    "rerender one look": ("rerender", "DATA/CW/test_1", "--look", "lab"),
    "rerender looks": ("rerender", "DATA/CW/test_1", "--looks", "lab"),
    "export": ("export", "DATA", "--format", "tum"),
    "bag": ("bag", "DATA"),
    "baselines": ("baselines", "DATA"),
    "model": ("model", "smoke"),
    "validate": ("validate", "motor"),
    "firmware": ("firmware",),
}
SHEETS = {
    "contact-sheet": ("contact-sheet", "DATA"),
    "preview": ("preview", "smoke", "--engine", "flat", "-n", "1"),
    "report": ("report", "DATA"),
}


def refused(symolo, root, arguments, out):
    before = sorted(root.rglob("*"))
    ended = symolo(*(str(word).replace("DATA", str(root)) for word in arguments), "--out", out)
    assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert sorted(root.rglob("*")) == before
    return ended.err


@pytest.mark.parametrize("command", MAKING)
def test_no_folder_is_made_within_a_dataset(command, dataset, copy_of, symolo):
    root = copy_of(dataset)
    for name in ("new", "CW/new", "CW/test_1/images/new/deep"):
        message = refused(symolo, root, MAKING[command], root / name)
        assert f"lies within the release {root}; name a place outside" in message
    assert symolo("verify", root).code == 0


@pytest.mark.parametrize("command", SHEETS)
def test_no_sheet_is_written_within_a_dataset(command, dataset, copy_of, symolo):
    root = copy_of(dataset)
    for name in ("sheet.html", "CW/sheet.html") if command == "report" else ("sheet.jpg", "CW/sheet.png"):
        assert f"lies within the release {root}" in refused(symolo, root, SHEETS[command], root / name)
    assert symolo("verify", root).code == 0


def test_neither_by_a_link_nor_by_standing_in_it_nor_in_one_that_is_not_finished(
    dataset, copy_of, tmp_path, symolo, monkeypatch
):
    root = copy_of(dataset)
    (tmp_path / "link").symlink_to(root)
    assert "lies within the release" in refused(symolo, root, MAKING["model"], tmp_path / "link/new")
    monkeypatch.chdir(root / "CW")
    ended = symolo("rerender", "test_1", "--look", "lab")
    assert (ended.code, f"lies within the release {root}" in ended.err) == (2, True)
    assert symolo("verify", root).code == 0
    begun = tmp_path / "begun"
    shutil.copytree(dataset / ".stages/simulate", begun / ".stages/simulate")
    assert f"lies within the release {begun}" in refused(symolo, begun, MAKING["model"], begun / "new")


def test_nor_within_a_bag(dataset, tmp_path, symolo):
    bag = tmp_path / "bag"
    assert symolo("bag", dataset, "--out", bag).code == 0
    for name, where in (("new", f"bag {bag}"), ("data", f"bag {bag}"), ("data/CW/new", f"release {bag / 'data'}")):
        assert f"lies within the {where}; name" in refused(symolo, bag, MAKING["model"], bag / name)


def test_beside_a_dataset_there_is_room(dataset, copy_of, symolo):
    root = copy_of(dataset)
    assert symolo("model", "smoke", "--out", root.parent / "new").code == 0
