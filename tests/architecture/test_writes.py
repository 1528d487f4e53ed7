"""Every file that the packages write gets its place in one way, that of `symolo.core.files.atomic_files`."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline", "symolo")
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
THE_WAY = "symolo/core/files/atomic_files.py"

WRITERS = {"write_text", "write_bytes", "savefig", "imwrite", "savez", "savez_compressed", "savetxt", "tofile"}
WRITERS |= {"copyfile", "copy2", "copytree", "move", "rename", "touch", "symlink_to", "hardlink_to", "save_as_mainfile"}
WRITERS |= {"unlink", "rmtree", "rmdir", "mkdir", "fdopen", "NamedTemporaryFile", "TemporaryDirectory", "mkdtemp"}
OF_NUMPY = {"np.save", "numpy.save", "np.memmap", "json.dump", "yaml.dump"}
"""Calls that write to a file, where a name alone would say too little."""

JUSTIFIED = {
    ("physics/bullet/body.py", "write_text"): "the URDF in a scratch folder, for PyBullet reads no text",
    ("hil/build.py", "write_text"): "sources in a scratch folder, for the compiler reads no text",
    ("pipeline/baselines/learned/model.py", "savez_compressed"): "into a buffer",
    ("symolo/core/tables/time_series.py", "savez_compressed"): "into a buffer",
    ("logs/bags/child.py", "savez"): "into the scratch folder of its owner",
    ("symolo/core/files/file_locks.py", "open"): "files that are locked and hold nothing",
    ("symolo/core/files/file_locks.py", "unlink"): "such a file of a folder that cannot be opened",
    ("symolo/pages/plotting.py", "savefig"): "into a buffer",
    ("symolo/core/child_process.py", "fdopen"): "the pipe to the owner",
    ("symolo/core/files/image_decoder_child.py", "fdopen"): "the pipes to the owner",
    ("symolo/core/files/scratch_folders.py", "mkdtemp"): "the only place that makes scratch folders",
    ("symolo/core/files/scratch_folders.py", "rmtree"): "scratch folders",
    ("symolo/core/files/scratch_folders.py", "unlink"): "files in abandoned scratch folders",
    ("symolo/core/child_process.py", "rmtree"): "the scratch folder of an owner that has died",
    ("blender_scenes/blender_side/hybrid/scenes.py", "unlink"): "of things from a scene; no file",
    ("blender_scenes/blender_side/matt_colors.py", "unlink"): "of things from a scene; no file",
    (
        "blender_scenes/blender_side/rendering.py",
        "unlink",
    ): "the picture in the scratch folder that Blender writes next",
}


def writes(tree):
    """What in a module writes, renames or removes files, with its line."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = ast.unparse(node.func)
        name = called.rsplit(".", 1)[-1]
        if name in WRITERS and not called.startswith("whole_files.") and isinstance(node.func, ast.Attribute):
            yield name, node.lineno
        elif called in OF_NUMPY:
            yield called, node.lineno
        elif name == "open" and _mode(node, called) & set("wax+"):
            yield "open", node.lineno
        elif name == "replace" and _is_of_a_path(node, called):
            yield "replace", node.lineno


def _mode(call, called):
    """Letters of the mode, of `open(path, mode)` and of `path.open(mode)`; what cannot be read may be any."""
    place = 1 if called in {"open", "io.open"} else 0
    given = [keyword.value for keyword in call.keywords if keyword.arg == "mode"] or call.args[place : place + 1]
    if called == "os.open":
        return set("w") if "O_CREAT" in ast.unparse(call) or "O_WRONLY" in ast.unparse(call) else set()
    if not given or not isinstance(given[0], ast.Constant):
        return set()
    return set(str(given[0].value))


def _is_of_a_path(call, called):
    """`path.replace(place)` has one argument, `text.replace(old, new)` two; `dataclasses.replace` has keywords."""
    return called == "os.replace" or ("." in called and len(call.args) == 1 and not call.keywords)


def found_in(path):
    return {(path.relative_to(ROOT).as_posix(), name) for name, _ in writes(ast.parse(path.read_text()))}


def test_nothing_writes_in_another_way():
    found = set().union(*(found_in(path) for path in MODULES if path.relative_to(ROOT).as_posix() != THE_WAY))
    assert found - JUSTIFIED.keys() == set()
    assert JUSTIFIED.keys() - found == set(), "these are justified no longer"


@pytest.mark.parametrize(
    "line",
    [
        "path.write_text('x')",
        "open('a', 'w')",
        "path.open('ab')",
        "open('a', mode='x')",
        "np.save('a', b)",
        "figure.savefig('a.png')",
        "cv2.imwrite('a.png', b)",
        "new.replace(old)",
        "os.replace(new, old)",
        "os.open('a', os.O_WRONLY | os.O_CREAT)",
        "shutil.copyfile(a, b)",
        "tempfile.TemporaryDirectory()",
    ],
)
def test_a_write_is_found(line):
    assert list(writes(ast.parse(line)))


@pytest.mark.parametrize(
    "line",
    ["open('a')", "path.open('rb')", "text.replace('a', 'b')", "replace(spec, seed=1)", "os.open(a, os.O_RDONLY)"],
)
def test_what_reads_is_none(line):
    assert not list(writes(ast.parse(line)))
