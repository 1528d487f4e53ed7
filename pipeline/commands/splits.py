"""The option `--splits` of `symolo export`."""

from pathlib import Path

from configs.schema.base import Section
from configs.schema.splits import Splits
from configs.validation.values import distributions_of, validated
from symolo.core.errors import InputError
from symolo.core.files.paths import check_path
from symolo.core.progress import plural
from symolo.core.yaml.reader import parse_yaml, read_yaml
from symolo.core.yaml.tree import Node
from symolo.exporters.shared.splits import OPTION, check_splits, divided
from symolo.exporters.shared.stereo import first_camera
from symolo.reader.dataset import Dataset

_NONE = "none"


class SplitsAlone(Section):
    """A file or text with nothing but splits."""

    splits: Splits


def with_splits(data: Dataset, text: str | None) -> Dataset:
    """Return the dataset with the splits of the option, or those of its metadata if the option is not given.

    Raises:
        InputError: The text is no rule, the rule does not fit the runs, or a split is empty.
    """
    if text is None:
        return check_splits(data)
    if text == _NONE or data.metadata is None:
        return divided(data, None)
    return divided(data, _splits(text).rule(data.metadata.seed))


def _splits(text: str) -> Splits:
    """Return the settings in a YAML text or file, which may have them under the key `splits` as a scenario does."""
    if text.lstrip().startswith("{"):
        node = parse_yaml(text, OPTION, with_lines=False)
    else:
        path = Path(text)
        check_path(path, OPTION)
        if not path.is_file():
            allowed = f"a YAML file, a text such as '{{by: run}}', or {_NONE}"
            raise InputError(OPTION, got=text, allowed=allowed, cure="there is no such file")
        node = read_yaml(path).root
    root = Node({"splits": node.child("splits") or node}, node.where)
    distributions_of(root, SplitsAlone)
    return validated(root, SplitsAlone, {}).splits


def split_line(data: Dataset) -> str:
    """Return one line with the number of runs, and of images of one camera, of each split."""
    splits = data.splits
    parts = []
    for name in splits.names if splits else ():
        if splits and splits.by == "image":
            parts.append(f"{name} {plural(len(data.split_images(name)), 'image')}")
            continue
        runs = data.split(name).runs
        images = sum(len(first_camera(run).numbers) for run in runs)
        parts.append(f"{name} {plural(len(runs), 'run')}, {plural(images, 'image')}")
    return f"splits: {'; '.join(parts)}"
