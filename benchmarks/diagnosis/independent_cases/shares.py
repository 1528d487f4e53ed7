"""Which category and which effects each case gets: 40 % one, 25 % two, 15 % none, 20 % outside."""

from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import deal

SHARES = {"one": 0.40, "two": 0.25, "none": 0.15, "outside": 0.20}


def deal_categories(rng: np.random.Generator, count: int) -> list[str]:
    """Return `count` categories in random order with the exact shares (largest remainders)."""
    exact = {name: share * count for name, share in SHARES.items()}
    whole = {name: int(value) for name, value in exact.items()}
    for name in sorted(exact, key=lambda n: whole[n] - exact[n])[: count - sum(whole.values())]:
        whole[name] += 1
    categories = [name for name, number in whole.items() for _ in range(number)]
    rng.shuffle(categories)
    return categories


def deal_names(
    rng: np.random.Generator, categories: Sequence[str], places: Mapping[str, str], outside: Sequence[str]
) -> list[list[str]]:
    """Return the names of every case; singles and pairs cycle through all, and a pair takes two places."""
    singles = iter(deal(rng, places, categories.count("one")))
    pool = deal(rng, places, 4 * categories.count("two") + 4)
    outsiders = iter(deal(rng, outside, 2 * categories.count("outside") + 2))
    names: list[list[str]] = []
    for category in categories:
        chosen: list[str] = []
        if category == "one":
            chosen = [next(singles)]
        elif category == "two":
            first = pool.pop(0)
            at = next(i for i, name in enumerate(pool) if places[name] != places[first])
            chosen = [first, pool.pop(at)]
        elif category == "outside":
            chosen = [next(outsiders)]
            if rng.random() < 0.15:
                chosen.append(next(outsiders))
        names.append(list(dict.fromkeys(chosen)))
    return names
