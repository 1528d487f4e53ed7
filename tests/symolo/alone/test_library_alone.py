"""The library without what makes data: beside foreign packages, without POSIX, and its commands without engines.

`.ci/library` runs this in environments that have neither Blender nor PyBullet; elsewhere they are hidden.
"""

import json
import shutil
import subprocess
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

import symolo
from pipeline.cli import main
from symolo.dataset.manifest import SIGNATURE, TAG_MANIFEST
from symolo.signing.key_files import read_secret_key
from symolo.signing.minisign import PublicKey, Signature

_PLACE = Path(__file__).parents[1] / "exporters" / "conftest.py"
_SPEC = spec_from_file_location("releases_of_noise", _PLACE)
_releases = module_from_spec(_SPEC)
_SPEC.loader.exec_module(_releases)
random_release = _releases.random_release

FORMATS = "tum,kitti,coco,yolo,webdataset,parquet,mcap,ros1,hdf5,huggingface,lerobot,rerun"
ROOT = Path(symolo.__file__).parents[1]
ABOUT = """
title: "Two drives"
authors: [{family: A laboratory}]
published: "2026-11-22"
publisher: Zenodo
"""
NO_ENGINES = ("bpy", "pybullet", "pybullet_data", "scipy", "serial")
NO_POSIX = ("fcntl", "resource", "pwd", "grp", "termios")
NOT_ON_WINDOWS = ("O_DIRECTORY", "O_NOFOLLOW", "O_CLOEXEC", "pathconf", "pread", "getuid")


def child(code, *arguments, hidden=(), cwd=None):
    """Run Python code in another process in which some modules cannot be imported."""
    hide = f"import sys; sys.modules.update(dict.fromkeys({hidden!r})); sys.path.append({str(ROOT)!r})\n"
    command = [sys.executable, "-c", hide + code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd)


@pytest.fixture
def release(random_release):
    return random_release(2, annotated=True).root


def test_it_is_imported_beside_packages_of_the_same_names_as_ours(release, tmp_path):
    for name in ("configs", "physics", "pipeline", "sensors"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("")
    code = (
        "sys.path.insert(0, ''); import symolo, configs; data = symolo.load(sys.argv[1]); run = data.runs[0]\n"
        "print(configs.__file__, len(data.rows), len(run.side('wheels')), run.camera.width_px, run.spec.route)"
    )
    ended = child(code, release, cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith(str(tmp_path))


def test_it_needs_nothing_that_only_posix_has(release, tmp_path):
    code = f"""
import importlib, os, pkgutil
for name in {NOT_ON_WINDOWS!r}:
    if hasattr(os, name):
        delattr(os, name)
import symolo
from pathlib import Path
left_out = ("symolo.storage.bucket",)
for module in pkgutil.walk_packages(symolo.__path__, "symolo."):
    importlib.import_module(module.name)
from symolo.core.files.atomic_files import append_line, make_folder, replace_folder, write_file
from symolo.core.files.file_locks import locked, locked_or_refused
from symolo.core.files.paths import check_new_path
folder = Path(sys.argv[2])
make_folder(folder / "new")
write_file(folder / "new/a.bin", b"a\\r\\n")
append_line(folder / "new/journal", b"one")
append_line(folder / "new/journal", b"two")
check_new_path(folder / "other", "--out")
with locked(folder), locked_or_refused(folder / "new", "here"):
    pass
replace_folder(folder / "new", folder / "moved")
data = symolo.load(sys.argv[1])
print((folder / "moved/journal").read_bytes(), len(data.rows), data.runs[0].images[0].pixels().shape)
"""
    ended = child(code, release, tmp_path, hidden=(*NO_POSIX, *NO_ENGINES))
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith(r"b'one\ntwo\n'")


def test_a_command_that_lacks_its_extra_names_it(tmp_path):
    code = "from pipeline.cli import main; sys.exit(main(sys.argv[1:]))"
    ended = child(code, "release", "smoke", "--out", tmp_path / "data", hidden=NO_ENGINES)
    assert ended.returncode == 5, ended.stderr
    assert ended.stderr.count("\n") == 1
    assert "install symolo with the extra `generate`" in ended.stderr
    assert not (tmp_path / "data").exists()


def test_signatures_are_made_and_checked_without_engines(release, tmp_path, capsys):
    release = shutil.copytree(release, tmp_path / "copy")
    secret, public = tmp_path / "symolo.key", str(tmp_path / "symolo.pub")
    assert main(["sign", "--new-key", str(secret), "--no-passphrase"]) == 0
    assert main(["sign", str(release), "--key", str(secret)]) == 2
    assert "is not signed, since it has faults" in capsys.readouterr().err, "it is a release of noise"
    key = read_secret_key(secret, str)
    data = (release / TAG_MANIFEST).read_bytes()
    (release / SIGNATURE).write_bytes(key.sign(data, "dataset:noise").to_bytes("by hand"))
    main(["verify", str(release), "--key", public])
    assert SIGNATURE not in capsys.readouterr().out
    (release / TAG_MANIFEST).write_bytes(data + b"\n")
    main(["verify", str(release), "--key", public])
    assert f"{SIGNATURE}: is by this key, but of other content" in capsys.readouterr().out


def test_a_signature_cannot_be_checked_without_its_extra(release, tmp_path):
    release = shutil.copytree(release, tmp_path / "copy")
    (release / SIGNATURE).write_bytes(Signature(b"ED", bytes(8), bytes(64), "", bytes(64)).to_bytes(""))
    public = tmp_path / "symolo.pub"
    public.write_text(PublicKey(bytes(8), bytes(32)).to_text())
    code = "from pipeline.cli import main; sys.exit(main(sys.argv[1:]))"
    ended = child(code, "verify", release, "--key", public, hidden=("cryptography",))
    assert ended.returncode == 5, ended.stderr
    assert "install symolo with the extra `sign`" in ended.stderr


def test_every_command_for_users_of_a_dataset_works_without_engines(release, tmp_path, capsys):
    about, store, bag = tmp_path / "about.yaml", (tmp_path / "store").as_uri(), tmp_path / "bag"
    about.write_text(ABOUT)
    done = (
        ["compare", release, release],
        ["export", release, "--format", FORMATS, "--out", tmp_path / "exported"],
        ["report", release, "--out", tmp_path / "report.html"],
        ["view", release, "--out", tmp_path / "view.html"],
        ["video", release, "--out", tmp_path / "video.gif", "--width-px", "320", "--fps", "2"],
        ["contact-sheet", release, "--out", tmp_path / "sheet.jpg"],
        ["pack", release, "--about", about, "--out", tmp_path / "upload"],
        ["bag", release, "--out", bag],
        ["upload", release, store],
        ["download", store, "--out", tmp_path / "fetched"],
    )
    for arguments in done:
        assert main([str(one) for one in arguments]) == 0, capsys.readouterr().err
    assert main(["compare", str(release), str(tmp_path / "fetched")]) == 0
    capsys.readouterr()
    assert main(["schema"]) == 0
    assert "properties" in json.loads(capsys.readouterr().out)
    # A release of noise has drives that no robot could make, and nothing that the checksums do not hold.
    assert main(["verify", str(release)]) == 4
    assert "SHA-256" not in capsys.readouterr().out
