"""What no file of the packages may do, each ban with its reason."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline", "symolo")
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
NOT_OURS = {".git", ".venv", "__pycache__", ".pytest_cache", ".ruff_cache", ".hypothesis", "symolo.egg-info"}

BANNED_IMPORTS = {
    "pickle": "runs code from a file",
    "marshal": "runs code from a file",
    "shelve": "runs code from a file",
    "random": "one generator for everything; draws are keyed by field path",
    "socket": "there is no network at run time",
    "requests": "there is no network at run time",
    "urllib": "there is no network at run time",
    "multiprocessing": "forks after engines are loaded, and pickles; workers are spawned by pipeline.work.supervisor",
}
ALLOWED = {"pipeline/executors/ray.py: socket": "a cluster that the user names is reached, and no other place"}
BANNED_CALLS = {
    "eval": "runs text from a file",
    "exec": "runs text from a file",
    "os.system": "runs a shell",
    "os.popen": "runs a shell",
    "os.fork": "engines do not survive it",
    "yaml.load": "builds any object; symolo.core.yaml.reader reads strictly",
    "tempfile.mktemp": "races",
    "tarfile.open": "reads what a stranger packed; archives are written here and never unpacked",
    "shutil.unpack_archive": "unpacks what a stranger packed",
    "np.random.default_rng": "seeds by order or by chance; symolo.core.random_streams keys by path",
}
ALLOWED_RANDOM = {"np.random.Generator", "np.random.PCG64", "numpy.random.Generator"}


def name_of(path):
    return path.relative_to(ROOT).as_posix()


def banned_imports(tree):
    for node in ast.walk(tree):
        if not isinstance(node, ast.Import | ast.ImportFrom):
            continue
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
        for name in names:
            if name.split(".")[0] in BANNED_IMPORTS:
                yield f"line {node.lineno}: {name} {BANNED_IMPORTS[name.split('.')[0]]}"


def banned_calls(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            if called in BANNED_CALLS:
                yield f"line {node.lineno}: {called} {BANNED_CALLS[called]}"
            if any(keyword.arg == "shell" for keyword in node.keywords):
                yield f"line {node.lineno}: {called} runs a shell"


def hidden_randomness(tree):
    """`np.random.normal` and its kin share one state; randomness comes from a generator that is passed."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) in {"np.random", "numpy.random"}:
            used = ast.unparse(node)
            if used not in ALLOWED_RANDOM:
                yield f"line {node.lineno}: {used}"


BANS = (banned_imports, banned_calls, hidden_randomness)


@pytest.fixture(scope="module")
def found():
    """Of each ban, the modules and what each does of it; all of one parse, which takes the most time."""
    found = {ban: [] for ban in BANS}
    for path in MODULES:
        tree = ast.parse(path.read_text())
        for ban in BANS:
            found[ban] += [(name_of(path), what) for what in ban(tree)]
    return found


@pytest.mark.parametrize("ban", BANS, ids=lambda ban: ban.__name__)
def test_no_module_does_what_is_banned(ban, found):
    assert len(MODULES) > 50
    strays = [
        f"{name}: {what}" for name, what in found[ban] if f"{name}: {what.split(': ')[1].split()[0]}" not in ALLOWED
    ]
    assert strays == []


def test_the_bans_find_what_they_ban():
    bad = ast.parse("from pickle import loads\nnp.random.normal()\neval('1')\nrun('x', shell=True)\n")
    assert [len(list(ban(bad))) for ban in BANS] == [1, 2, 1]


def test_a_file_is_one_idea():
    catch_alls = {"utils", "util", "helpers", "common", "misc"}
    assert [name_of(path) for path in MODULES if path.stem in catch_alls] == []
    assert [name_of(path) for path in MODULES if len(path.read_text().splitlines()) > 400] == []


def test_no_path_of_one_machine_is_in_the_tree():
    pattern = re.compile(r"(?:^|[^A-Za-z0-9_./])/(?:root|work|farm|home|Users|opt)/", re.MULTILINE)
    assert pattern.search("see /" + "home/anna/x"), "the pattern finds what it is for"
    kinds = {".py", ".md", ".yaml", ".toml", ".lock", ".sh", ""}
    found = []
    for path in our_files(ROOT):
        if path.suffix in kinds:
            text = path.read_text(errors="replace")
            found += [f"{name_of(path)}: {match.group()}" for match in pattern.finditer(text)]
    assert found == []


def our_files(folder):
    for path in folder.iterdir():
        if path.name in NOT_OURS:
            continue
        if path.is_dir() and not path.is_symlink():
            yield from our_files(path)
        elif path.is_file():
            yield path
