"""Every file of a dataset is opened in one way, that of `symolo.core.files.plain_files`.

Its images are decoded in one way too, that of `symolo.dataset.pixels`, and all images of others in a child.
"""

import ast
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("symolo", "logs", "pipeline", "diagnosis", "blender_scenes")
"""Those that read datasets."""
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
THE_WAY = "symolo/core/files/plain_files.py"

READERS = {
    "read_text",
    "read_bytes",
    "imread",
    "imdecode",
    "imdecodemulti",
    "imreadmulti",
    "fromfile",
    "memmap",
    "loadtxt",
    "genfromtxt",
}
READERS |= {"copyfile", "copy2", "copytree", "copyfileobj", "readlines", "FileIO", "ZipFile", "TarFile", "mmap"}
DECODERS = {"imread", "imdecode", "imdecodemulti", "imreadmulti"}
DECODING = {
    "symolo/core/files/image_decoder_child.py",
    "blender_scenes/render/frame_files.py",
    "pipeline/preview/engines.py",
    "sensors/camera/exposure_guard.py",
    "sensors/camera/response.py",
}
"""The child that decodes images of strangers, and what decodes images that symolo has just made."""
OF_MODULES = {
    "np.load",
    "numpy.load",
    "json.load",
    "yaml.load",
    "tarfile.open",
    "h5py.File",
    "os.open",
    "fileinput.input",
}
OF_MODULES |= {"io.open", "codecs.open", "gzip.open", "lzma.open", "bz2.open"}
"""Calls that open a file, where a name alone would say too little."""
OF_PANDAS = ("pd.read_", "pandas.read_", "pq.read_", "pyarrow.")
OPENERS = ("open", "fdopen")

JUSTIFIED = {
    ("pipeline/preview/engines.py", "imdecode"): "what Blender has just made, as scratch",
    ("blender_scenes/render/frame_files.py", "imdecode"): "what was just encoded",
    ("blender_scenes/blender_side/rendering.py", "read_bytes"): "the picture that Blender has just made, as scratch",
    ("pipeline/commands/datasets/sign.py", "read_text"): "a passphrase, which a shell may give by a pipe",
    ("pipeline/doctor.py", "read_text"): "the lock of our packages, and /proc",
    ("pipeline/run_folder/worker.py", "os.open"): "the lock of a folder, which is not read",
    ("pipeline/run_folder/worker.py", "read_text"): "/proc",
    ("pipeline/work/processors.py", "read_text"): "/proc",
    ("pipeline/work/worker_process.py", "read_text"): "/sys",
    ("symolo/core/child_process.py", "fdopen"): "the pipe to the owner",
    ("symolo/core/child_process.py", "read_text"): "/proc",
    ("symolo/core/files/atomic_files.py", "os.open"): "files that are written, and folders",
    ("symolo/core/files/atomic_files.py", "read_bytes"): "what was just written beside its place",
    ("symolo/core/files/file_locks.py", "os.open"): "files and folders that are locked and not read",
    ("symolo/core/files/image_decoder_child.py", "fdopen"): "the pipes to the owner",
    ("symolo/core/files/image_decoder_child.py", "imdecode"): "in the child, within its limits",
    ("symolo/core/files/image_decoder_child.py", "os.open"): "the null device",
    ("symolo/core/process_limits.py", "read_text"): "/proc",
    ("symolo/core/files/npz_file.py", "ZipFile"): "from a buffer",
    ("symolo/exporters/mcap.py", "read_bytes"): "what a library has just written, as scratch",
    ("symolo/exporters/ros1.py", "read_bytes"): "what a library has just written, as scratch",
}


def reads(tree):
    """What in a module opens files in a way of its own, with its line."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr in READERS:  # called, or passed to somebody who calls it
            yield node.attr, node.lineno
        if not isinstance(node, ast.Call):
            continue
        called = ast.unparse(node.func)
        if called in OF_MODULES or called.startswith(OF_PANDAS):
            yield called, node.lineno
        elif called == "open" or (called.rsplit(".", 1)[-1] in OPENERS and _is_of_a_path(node)):
            yield called.rsplit(".", 1)[-1], node.lineno


def _is_of_a_path(call):
    """`path.open("rb")`, and not `Batch.open(scenario, ...)`: a mode is one short word, or there is no argument."""
    if not isinstance(call.func, ast.Attribute):
        return False
    modes = [argument.value for argument in call.args if isinstance(argument, ast.Constant)]
    given = {keyword.arg for keyword in call.keywords}
    return given <= {"mode", "encoding", "errors", "newline", "buffering"} and (
        call.func.attr == "fdopen" or not call.args or any(isinstance(mode, str) and len(mode) <= 3 for mode in modes)
    )


@cache
def found_in(path):
    return {(path.relative_to(ROOT).as_posix(), name) for name, _ in reads(ast.parse(path.read_text()))}


def test_nothing_opens_files_in_another_way():
    found = set().union(*(found_in(path) for path in MODULES if path.relative_to(ROOT).as_posix() != THE_WAY))
    assert found - JUSTIFIED.keys() == set()
    assert JUSTIFIED.keys() - found == set(), "these are justified no longer"


def test_images_of_strangers_are_decoded_in_the_child_alone():
    packages = (*PACKAGES, "configs", "physics", "sensors", "hil")
    modules = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    found = {path.relative_to(ROOT).as_posix() for path in modules if {name for _, name in found_in(path)} & DECODERS}
    assert found == DECODING


@pytest.mark.parametrize(
    "line",
    [
        "open('a')",
        "path.open()",
        "path.open('rb')",
        "path.open(encoding='utf-8')",
        "path.read_bytes()",
        "File(name, path.read_bytes)",
        "Path('a').read_text(encoding='ascii')",
        "cv2.imread('a.png')",
        "np.load(path)",
        "np.fromfile(path)",
        "pd.read_csv(path)",
        "pandas.read_parquet(path)",
        "json.load(file)",
        "tarfile.open(path)",
        "zipfile.ZipFile(path)",
        "os.open(path, os.O_RDONLY)",
        "os.fdopen(number)",
        "shutil.copyfile(a, b)",
    ],
)
def test_a_read_is_found(line):
    assert list(reads(ast.parse(line)))


@pytest.mark.parametrize(
    "line",
    [
        "read_file(path, FileKind.TABLE)",
        "open_file(path)",
        "Batch.open(scenario, overrides, out)",
        "Bucket.open(url, endpoint, allow_http=True)",
        "json.loads(data)",
        "read_csv(path, columns)",
    ],
)
def test_what_opens_no_file_is_none(line):
    assert not list(reads(ast.parse(line)))
