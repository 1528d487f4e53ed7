"""Who may import whom, and what importing does."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline", "symolo")
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

ENGINES = {
    "pybullet": "physics/bullet/",
    "pybullet_data": "physics/bullet/",
    "bpy": "blender_scenes/blender_side/",
    "bmesh": "blender_scenes/blender_side/",
    "mathutils": "blender_scenes/blender_side/",
    "serial": "hil/links/",
    "obstore": "symolo/storage/bucket.py",
    "ray": "pipeline/executors/ray.py",
    "torch": "pipeline/baselines/learned/torch_side/",
}


def name_of(path):
    return path.relative_to(ROOT).as_posix()


def imported(tree):
    """Top-level names of every import, also of those inside functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.split(".")[0]


def test_there_are_modules_to_look_at():
    assert {name_of(path).split("/")[0] for path in MODULES} == set(PACKAGES)


def test_layers_hold():
    lint = Path(sys.executable).with_name("lint-imports")
    linted = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert linted.returncode == 0, linted.stdout


def in_circles(imports):
    """Modules that import one another, directly or not, and those between two such circles."""
    rest = dict(imports)
    while True:
        imported_by_rest = set().union(*rest.values())
        inner = {m: rest[m] & rest.keys() for m in rest if rest[m] & rest.keys() and m in imported_by_rest}
        if inner.keys() == rest.keys():
            return set(inner)
        rest = inner


@pytest.mark.parametrize(
    ("imports", "circle"),
    [
        ({"a": {"b"}, "b": {"c"}, "c": set()}, set()),
        ({"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set()}, {"b", "c"}),
    ],
)
def test_a_circle_is_detected(imports, circle):
    assert in_circles(imports) == circle


def test_no_modules_import_one_another():
    """Imports inside functions and those for type checks alone count too."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert in_circles(imports) == set()


def strays_in(name, tree):
    return [f"{name}: {module}" for module in imported(tree) if not name.startswith(ENGINES.get(module, ""))]


def test_an_engine_is_imported_in_one_folder_only(faults):
    assert [stray for strays, _ in faults for stray in strays] == []


REGISTERS = {"pipeline/gym/__init__.py"}
"""Modules that Gymnasium imports by `make("module:name")`, and which it expects to register their environments."""


def does_something(node):
    """A module defines and imports; a loop, a branch or a bare call at its top level does something."""
    is_docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    is_guard = isinstance(node, ast.If) and ast.unparse(node.test) in {"TYPE_CHECKING", "__name__ == '__main__'"}
    defines = ast.Import | ast.ImportFrom | ast.FunctionDef | ast.ClassDef | ast.Assign | ast.AnnAssign
    return not (is_docstring or is_guard or isinstance(node, defines))


def actions_in(name, tree):
    actions = [node for node in tree.body if does_something(node) and name not in REGISTERS]
    return [f"{name}: line {node.lineno}: {ast.unparse(node)[:80]}" for node in actions]


@pytest.fixture(scope="module")
def faults():
    """Of each module, the engines that it imports elsewhere and what it does at import; of one parse of it."""
    sources = ((name_of(path), ast.parse(path.read_text())) for path in MODULES)
    return [(strays_in(name, tree), actions_in(name, tree)) for name, tree in sources]


def test_nothing_happens_at_import(faults):
    assert does_something(ast.parse("import x\nx.start()").body[1]), "the check finds what it is for"
    assert [action for _, actions in faults for action in actions] == []


def test_importing_the_pipeline_loads_no_engine():
    modules = [
        "pipeline",
        "pipeline.cli",
        "pipeline.work.batch",
        "pipeline.rerendering.rerender",
        "symolo.verification.verify",
    ]
    program = f"import json, sys, {', '.join(modules)}; print(json.dumps(sorted(sys.modules)))"
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = set(json.loads(process.stdout))
    assert loaded >= set(modules)
    assert loaded.isdisjoint(ENGINES)
