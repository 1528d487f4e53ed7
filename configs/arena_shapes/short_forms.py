"""The common part of the short forms of an arena: each is checked by itself and replaced before anything is drawn."""

from typing import TypeVar

from configs.schema.base import Section
from configs.validation.shapes import Shape, with_defaults
from configs.validation.values import distributions_of, validated
from symolo.core.errors import InputError
from symolo.core.yaml.tree import FieldPath, Node, dotted

Alone = TypeVar("Alone", bound=Section)


def checked_alone(root: Node, path: FieldPath, model: type[Alone], cure: str) -> Alone:
    """Return a part of a tree, in a section that holds this part alone, so that messages have its path.

    Args:
        root: Tree of a scenario, or of a section.
        path: Path of the part.
        model: A section with the fields on this path and no others.
        cure: Advice about a distribution, which the part must not have.

    Raises:
        InputError: The part is wrong or has a distribution.
    """
    tree = root.at(path) or Node(None, root.where)
    for key in reversed(path):
        tree = Node({str(key): tree}, tree.where)
    tree = with_defaults(tree, Shape.from_model(model))
    for random in distributions_of(tree, model):
        raise InputError(f"{dotted(random)}: no distribution is allowed here", where=tree.place_of(random), cure=cure)
    return validated(tree, model, {})
