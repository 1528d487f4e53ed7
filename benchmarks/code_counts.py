"""Print how large the tree is and how plain its words are: `python benchmarks/code_counts.py [TREE]`."""

import ast
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from pathlib import Path

PACKAGES = ("symolo", "configs", "logs", "physics", "sensors", "hil", "diagnosis", "blender_scenes", "pipeline")
WORDS = ("told", "tells", "asked", "anew", "mended", "mends", "so-manieth")
VARIABLES = ("found", "of", "own", "given", "told", "side", "way", "kept")
BOUNDS = ("least_", "most_", "min_", "max_")


def main() -> None:
    """Print the counts of the tree that the command line names, by default the current folder."""
    root = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    modules = {path: path.read_text(encoding="utf-8") for path in sorted(_modules(root))}
    print_sizes(root, modules)
    print_words(modules)
    print_names(root, modules)


def _modules(root: Path) -> Iterator[Path]:
    for package in (*PACKAGES, "firmware"):
        yield from (root / package).rglob("*.py")


def print_sizes(root: Path, modules: dict[Path, str]) -> None:
    """Print lines and files per package, and folders with more than 15 loose modules."""
    lines: Counter[str] = Counter()
    files: Counter[str] = Counter()
    loose: Counter[str] = Counter()
    for path, text in modules.items():
        package = path.relative_to(root).parts[0]
        lines[package] += len(text.splitlines())
        files[package] += 1
        loose[path.relative_to(root).parent.as_posix()] += path.name != "__init__.py"
    for package in sorted(lines):
        print(f"{package:16} {lines[package]:6} lines {files[package]:4} files")
    print(f"{'in all':16} {sum(lines.values()):6} lines {sum(files.values()):4} files")
    crowded = ", ".join(f"{folder} {count}" for folder, count in sorted(loose.items()) if count > 15)
    print(f"folders of more than 15 modules: {crowded or 'none'}")


def print_words(modules: dict[Path, str]) -> None:
    """Print how often words and variable names occur that the house style replaces."""
    text = "\n".join(modules.values())
    words = ", ".join(f"{word} {len(re.findall(rf'{chr(92)}b{word}{chr(92)}b', text))}" for word in WORDS)
    bounds = ", ".join(f"{word} {len(re.findall(rf'(?i){chr(92)}b_?{word}[a-z]', text))}" for word in BOUNDS)
    images = ", ".join(f"{word} {len(re.findall(rf'(?i){word}', text))}" for word in ("picture", "image"))
    print(f"words: {words}\nbounds: {bounds}\n{images}")


def print_names(root: Path, modules: dict[Path, str]) -> None:
    """Print variables and classes whose names say little, fragments of field docstrings, and import circles."""
    stored: Counter[str] = Counter()
    classes: dict[str, set[str]] = defaultdict(set)
    fields = fragments = 0
    imports: dict[str, set[str]] = {}
    names = {_name(root, path): path for path in modules}
    for name, path in names.items():
        tree = ast.parse(modules[path])
        imports[name] = set(_targets(tree, name, path, names.keys()))
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                stored[node.id] += 1
            elif isinstance(node, ast.arg):
                stored[node.arg] += 1
            elif isinstance(node, ast.ClassDef):
                classes[node.name].add(name)
                docstrings = list(_field_docstrings(node))
                fields += len(docstrings)
                fragments += sum(_is_fragment(text) for text in docstrings)
    print("variables: " + ", ".join(f"{name} {stored[name]}" for name in VARIABLES))
    shared = sorted(name for name, places in classes.items() if len(places) > 1)
    print(f"class names that several modules use: {len(shared)}: {', '.join(shared)}")
    print(f"field docstrings: {fields}, of which begin with no noun: {fragments}")
    circles = list(_circles(imports))
    print(f"import circles: {len(circles)} of {[len(circle) for circle in circles]} modules")


def _name(root: Path, path: Path) -> str:
    return ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")


def _targets(tree: ast.AST, name: str, path: Path, modules: AbstractSet[str]) -> Iterator[str]:
    """Yield the modules of the tree that a module imports; what is imported from a package counts as the package."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules)
        elif isinstance(node, ast.ImportFrom):
            package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            targets = {f"{module}.{alias.name}" for alias in node.names}
            yield from targets & modules
            if module in modules and not targets <= modules:
                yield module


def _field_docstrings(node: ast.ClassDef) -> Iterator[str]:
    for field, after in zip(node.body, node.body[1:], strict=False):
        is_text = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        if isinstance(field, ast.AnnAssign) and is_text:
            yield str(after.value.value)


def _is_fragment(text: str) -> bool:
    """Return whether a field docstring begins with a preposition, a pronoun or a conjunction: an estimate."""
    return bool(re.match(r"(Of|By|In|From|To|As|At|Where|What|Which|How|Whether|Likewise|And|None|Up to|With)\b", text))


def _circles(imports: dict[str, set[str]]) -> Iterator[list[str]]:
    """Yield the groups of modules that import each other (Tarjan's strongly connected components)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    components: list[list[str]] = []

    def visit(module: str) -> None:
        index[module] = low[module] = len(index)
        stack.append(module)
        for target in imports[module]:
            if target not in index:
                visit(target)
            if target in stack:
                low[module] = min(low[module], low[target])
        if low[module] == index[module]:
            circle = [stack.pop()]
            while circle[-1] != module:
                circle.append(stack.pop())
            components.append(circle)

    sys.setrecursionlimit(10_000)
    for module in imports:
        if module not in index:
            visit(module)
    yield from (circle for circle in components if len(circle) > 1)


if __name__ == "__main__":
    main()
