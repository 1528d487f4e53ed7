"""Assignment of runs or images to training, validation and test, by their groups or as the user lists them."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from types import MappingProxyType

from symolo.core.errors import InputError, together
from symolo.core.progress import plural
from symolo.core.random_streams import stream
from symolo.dataset.documents.origin import Origin
from symolo.dataset.documents.splits_record import SPLIT_NAMES, Grouping, SplitName, SplitsRecord, Stratum

DEFAULT_SHARES: Mapping[SplitName, float] = {"train": 0.7, "validation": 0.15, "test": 0.15}
_MAX_LISTED = 5


@dataclass(frozen=True)
class SplitRule:
    """How a dataset is divided: by groups with shares, or by patterns of the names of runs."""

    by: Grouping | None
    """Property by which runs are grouped; None if `patterns` assigns them."""
    shares: Mapping[SplitName, float]
    """Share of the groups in each split; the sum is 1."""
    patterns: Mapping[SplitName, Sequence[str]]
    """Patterns of names such as `CW/*` for each split; empty unless `by` is None."""
    seed: int
    stratify: tuple[Stratum, ...] = ()
    """Properties whose values are mixed about alike in all splits."""


@dataclass(frozen=True)
class SplitMember:
    """A run with the properties by which it can be grouped."""

    run: str
    """Name of the run, for example `CW/test_1`."""
    look: str
    robot: str
    seed: int
    origin: Origin | None = None
    images: Sequence[int] = ()
    """Numbers of the images; they matter only for splits by image."""
    arena: str = ""
    """Fingerprint of the arena; it matters only for splits by arena."""

    @property
    def trajectory(self) -> str:
        """Name of the run that was driven. Runs that show one trajectory under several looks have the same."""
        release = self.origin.release if self.origin else None
        return release.run if release else self.run

    def group(self, by: Grouping) -> str:
        """Return the name of its group."""
        groups: Mapping[Grouping, str] = {
            "run": self.trajectory,
            "route": self.trajectory.rpartition("/")[0],
            "look": self.look,
            "robot": self.robot,
            "arena": self.arena,
            "seed": str(self.seed),
            "image": self.run,
        }
        return groups[by]


def assign(rule: SplitRule, members: Sequence[SplitMember], where: str) -> SplitsRecord:
    """Return the split of every run or image; the same rule and members give the same splits.

    Groups are put into a random order that depends on the seed and their names only. The first ones are those of
    training, then come those of validation and test. With `stratify`, the same is done within each stratum.

    Args:
        rule: How the dataset is divided.
        members: All runs.
        where: Place of the rule, for messages.

    Raises:
        InputError: There are fewer groups than splits, or the patterns do not assign each run to one split.
    """
    if rule.by is None:
        return SplitsRecord(by="listed", seed=rule.seed, runs=_listed(rule.patterns, members, where))
    if rule.by == "image":
        return SplitsRecord(by="image", seed=rule.seed, images=_divided(rule, members, where))
    names = _groups(rule, rule.by, members, where)
    keys = {name: stream(rule.seed, "splits", rule.by, name).random() for name in names}
    in_order, split_of = sorted(names, key=lambda name: keys[name]), {}
    strata = _strata(rule, rule.by, members)
    groups = [[name for name in in_order if strata[name] == stratum] for stratum in sorted(set(strata.values()))]
    for ones, splits in zip(groups, _in_strata([len(ones) for ones in groups], rule.shares), strict=True):
        split_of |= dict(zip(ones, splits, strict=True))
    runs: dict[SplitName, tuple[str, ...]] = {
        split: tuple(member.run for member in members if split_of[member.group(rule.by)] == split)
        for split in SPLIT_NAMES
        if split in rule.shares
    }
    return SplitsRecord(by=rule.by, seed=rule.seed, stratify=rule.stratify, runs=runs)


def check(rule: SplitRule, members: Sequence[SplitMember], where: str) -> None:
    """Refuse a rule that cannot be applied to runs that are planned; their images are not known yet.

    Raises:
        InputError: As for `assign`.
    """
    if rule.by is None:
        _listed(rule.patterns, members, where)
    elif rule.by != "image":
        _groups(rule, rule.by, members, where)


def _groups(rule: SplitRule, by: Grouping, members: Sequence[SplitMember], where: str) -> list[str]:
    """Return the sorted names of the groups, at least one for each split."""
    names = sorted({member.group(by) for member in members})
    if len(names) < len(rule.shares):
        raise _too_few(by, names, rule.shares, where)
    return names


def _in_order(count: int, shares: Mapping[SplitName, float]) -> list[SplitName]:
    """Return the split of each of `count` things in their random order; each split has at least one of them."""
    names: list[SplitName] = [name for name in SPLIT_NAMES if name in shares]
    sizes = [max(1, math.floor(shares[name] * count)) for name in names]
    while (missing := count - sum(sizes)) != 0:
        lacking = [shares[name] * count - size for name, size in zip(names, sizes, strict=True)]
        if missing > 0:
            sizes[lacking.index(max(lacking))] += 1
        else:
            sizes[min((index for index, size in enumerate(sizes) if size > 1), key=lacking.__getitem__)] -= 1
    in_order: list[SplitName] = [name for name, size in zip(names, sizes, strict=True) for _ in range(size)]
    return in_order


def _strata(rule: SplitRule, by: Grouping, members: Sequence[SplitMember]) -> dict[str, tuple[tuple[str, ...], ...]]:
    """Return the stratum of each group: the values that its members have of each property, in order."""
    values: dict[str, tuple[set[str], ...]] = {}
    for member in members:
        group_values = values.setdefault(member.group(by), tuple(set() for _ in rule.stratify))
        for known, name in zip(group_values, rule.stratify, strict=True):
            known.add(member.group(name))
    return {name: tuple(tuple(sorted(known)) for known in group_values) for name, group_values in values.items()}


def _in_strata(counts: Sequence[int], shares: Mapping[SplitName, float]) -> list[list[SplitName]]:
    """Return the splits of the things of each stratum, of which there are `counts`, in their random order.

    Each split has as many things as without strata, and of each stratum its share, rounded down or up. Such a rounding
    exists for every table of shares; it is that of a matrix of zeros and ones with given sums of rows and columns (Gale
    and Ryser, 1957), whose rows are filled where the sums of the columns lack most.
    """
    in_order = _in_order(sum(counts), shares)
    sizes = Counter(in_order)
    names: list[SplitName] = [name for name in SPLIT_NAMES if name in shares]
    exact = [{name: count * sizes[name] / len(in_order) for name in names} for count in counts]
    table = [{name: math.floor(row[name] + 1e-9) for name in names} for row in exact]
    lacking = {name: sizes[name] - sum(row[name] for row in table) for name in names}
    for count, row in zip(counts, table, strict=True):
        missing = count - sum(row.values())
        for name in sorted(names, key=lambda name: -lacking[name])[:missing]:
            row[name] += 1
            lacking[name] -= 1
    return [[name for name in names for _ in range(row[name])] for row in table]


def _divided(
    rule: SplitRule, members: Sequence[SplitMember], where: str
) -> dict[SplitName, dict[str, tuple[int, ...]]]:
    """Return the images of each split by run, for splits by image."""
    images = [(member.run, number) for member in members for number in member.images]
    if len(images) < len(rule.shares):
        raise InputError(
            f"splits: {plural(len(images), 'image')} for {plural(len(rule.shares), 'split')}",
            where=where,
            cure="remove shares, or make more images",
        )
    keys = [
        key
        for member in members
        for key in stream(rule.seed, "splits", "image", member.run).random(len(member.images)).tolist()
    ]
    order = sorted(range(len(images)), key=lambda index: keys[index])
    splits: dict[SplitName, dict[str, list[int]]] = {name: {} for name in rule.shares}
    for index, split in sorted(zip(order, _in_order(len(images), rule.shares), strict=True)):
        run, number = images[index]
        splits[split].setdefault(run, []).append(number)
    return {name: {run: tuple(numbers) for run, numbers in runs.items()} for name, runs in splits.items()}


_MORE_GROUPS: Mapping[Grouping, str] = MappingProxyType(
    {
        "run": "write shares of fewer splits, or make more runs",
        "arena": "give routes arenas of their own; divide by run; or write shares of fewer splits",
    }
)


def _too_few(by: Grouping, names: Sequence[str], shares: Mapping[SplitName, float], where: str) -> InputError:
    listed = _some(names)
    groups = f"the groups are {listed}"
    if by == "arena":
        groups = "all runs have the same arena" if len(names) == 1 else "runs with the same arena are one group"
    elif len(names) == 1 and by in {"look", "robot", "seed", "route"}:
        groups = f"all runs have the same {by} ({listed})"
    too_few = f"{plural(len(names), 'group')} {'is' if len(names) == 1 else 'are'} too few"
    return InputError(
        f"splits.by: {too_few} for {plural(len(shares), 'split')}: {groups}",
        where=where,
        got=by,
        allowed=f"a property that has at least {plural(len(shares), 'value')} in these runs",
        cure=_MORE_GROUPS.get(by, "divide by run, or write shares of fewer splits"),
    )


def _listed(
    patterns: Mapping[SplitName, Sequence[str]], members: Sequence[SplitMember], where: str
) -> dict[SplitName, tuple[str, ...]]:
    """Return the runs of each split whose names match its patterns."""
    names = [member.run for member in members]
    splits: dict[SplitName, tuple[str, ...]] = {
        split: tuple(name for name in names if any(fnmatchcase(name, pattern) for pattern in patterns[split]))
        for split in SPLIT_NAMES
        if split in patterns
    }
    if faults := [*_unmatched(patterns, names, where), *_not_in_one_split(splits, names, where)]:
        raise together(faults)
    return splits


def _unmatched(patterns: Mapping[SplitName, Sequence[str]], names: Sequence[str], where: str) -> Iterator[InputError]:
    """Yield a fault for each pattern that no run matches."""
    for split, ones in patterns.items():
        for pattern in ones:
            if not any(fnmatchcase(name, pattern) for name in names):
                what, allowed = f"splits.runs.{split}: no run matches", f"a pattern of names such as {_some(names)}"
                yield InputError(what, where=where, got=pattern, allowed=allowed)


def _not_in_one_split(
    splits: Mapping[SplitName, Sequence[str]], names: Sequence[str], where: str
) -> Iterator[InputError]:
    """Yield a fault for the runs that are in the same several splits, and one for those that are in none."""
    names_by_splits: dict[tuple[SplitName, ...], list[str]] = {}
    for name in names:
        names_by_splits.setdefault(tuple(split for split, runs in splits.items() if name in runs), []).append(name)
    for in_splits, runs in names_by_splits.items():
        what = (
            f"splits.runs: {_some(runs)} {'is' if len(runs) == 1 else 'are'} in {' and '.join(in_splits) or 'no split'}"
        )
        cure = (
            "give each run to one of them" if in_splits else "add each to a split; `export` leaves runs out with --runs"
        )
        if len(in_splits) != 1:
            yield InputError(what, where=where, cure=cure)


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:_MAX_LISTED]) + (", ..." if len(names) > _MAX_LISTED else "")
