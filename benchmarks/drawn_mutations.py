"""Random changes of modules: the places of the operators of cosmic-ray, and one change for each place that is drawn."""

import ast
import hashlib
import random
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import cosmic_ray.ast  # pyright: ignore[reportMissingImports]
from cosmic_ray.operators.operator import Operator  # pyright: ignore[reportMissingImports]
from cosmic_ray.plugins import get_operator, operator_names  # pyright: ignore[reportMissingImports]

ROOT = Path(__file__).parents[1]
KINDS = (
    {"Add", "Sub", "Mul", "Div", "FloorDiv", "Mod", "Pow"},
    {"BitOr", "BitAnd", "BitXor"},
    {"Eq", "NotEq", "Lt", "LtE", "Gt", "GtE"},
    {"Is", "IsNot"},
)
"""An operator is replaced by one of its kind only, for no number has bits and an error of types is always noticed."""
NEEDS_ARGUMENTS = ("VariableReplacer", "VariableInserter")
"""Changes that need names of variables."""


class ScaledNumber(Operator):
    """Replaces a number that is not whole by one half as large again, which a sum of 1 may hide or exaggerate."""

    def mutation_positions(self, node):  # noqa: ANN001, ANN201 - a node of parso
        if node.type == "number" and isinstance(ast.literal_eval(node.value), float) and float(node.value):
            yield node.start_pos, node.end_pos

    def mutate(self, node, index):  # noqa: ANN001, ANN201, ARG002
        node.value = repr(1.5 * float(node.value))
        return node

    @classmethod
    def examples(cls):  # noqa: ANN206
        return (("x = 2.0", "x = 3.0"),)


@dataclass(frozen=True)
class Mutation:
    """One change of one module."""

    module: str
    line: int
    operator: str
    occurrence: int
    """Number of the place among those of the operator in the module."""
    source: str
    """Short hash of the module's text."""


def operators_by_name() -> dict[str, Operator]:
    """Return the changes by name."""
    names = [name for name in operator_names() if not name.endswith(NEEDS_ARGUMENTS)]
    pairs = {name: set(name.split("_")[1:]) for name in names if "BinaryOp" in name or "Comparison" in name}
    names = [name for name in names if name not in pairs or any(pairs[name] <= kind for kind in KINDS)]
    return {name: get_operator(name)() for name in names} | {"scaled number": ScaledNumber()}


def drawn_mutations(modules: Iterable[str], number: int, seed: int) -> Iterator[Mutation]:
    """Yield one change each of randomly drawn places."""
    known = operators_by_name()
    places, sources = defaultdict(list), {}
    for module in modules:
        text = (ROOT / module).read_text()
        sources[module] = hashlib.sha256(text.encode()).hexdigest()[:12]
        lines, annotations = text.splitlines(), list(_annotations(text))
        nodes = list(cosmic_ray.ast.ast_nodes(cosmic_ray.ast.get_ast(text)))
        for name, operator in known.items():
            spans = [span for node in nodes for span in operator.mutation_positions(node)]
            for occurrence, (start, end) in enumerate(spans):
                is_separator = lines[start[0] - 1].startswith("*,", start[1])  # of arguments, and no product
                if not is_separator and not any(low <= start and end <= high for low, high in annotations):
                    places[module, start, end].append((name, occurrence))
    draw = random.Random(seed)  # noqa: S311 - a sample, not a secret
    for module, start, end in draw.sample(sorted(places), min(number, len(places))):
        name, occurrence = draw.choice(places[module, start, end])
        yield Mutation(module, start[0], name, occurrence, sources[module])


def _annotations(text: str) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    for node in ast.walk(ast.parse(text)):
        for name in ("annotation", "returns"):
            if (part := getattr(node, name, None)) is not None:
                yield (part.lineno, part.col_offset), (part.end_lineno, part.end_col_offset)
