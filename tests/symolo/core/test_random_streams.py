import itertools

import numpy as np

from symolo.core.random_streams import stream


def first(seed: int, *path: str | int) -> float:
    return float(stream(seed, *path).random())


def test_a_stream_is_a_function_of_its_key():
    assert np.array_equal(stream(3, "CW", 1, "tof").random(100), stream(3, "CW", 1, "tof").random(100))


def test_keys_that_look_alike_have_streams_of_their_own():
    keys = [
        (1,),
        (1, ""),
        (1, "a", "b"),
        (1, "a.b"),
        (1, "ab"),
        (1, "a", 1),
        (1, "a", "1"),
        (1, "a", 11),
        (1, 1, "a"),
        (11, "a"),
    ]
    values = [first(*key) for key in keys]
    assert len(set(values)) == len(values)


def test_seed_zero_is_a_seed_like_any_other():
    assert first(0, "a") == first(0, "a")
    assert first(0, "a") != first(1, "a")


def test_neighbouring_runs_are_uncorrelated():
    """Correlation of n independent pairs has sd 1 / sqrt(n)."""
    count = 4000
    one = np.array([first(5, "CW", run, "look.sun.elevation_deg") for run in range(count)])
    assert abs(one.mean() - 0.5) < 5 * np.sqrt(1 / 12 / count)
    assert abs(np.corrcoef(one[:-1], one[1:])[0, 1]) < 5 / np.sqrt(count)


def test_long_streams_of_two_fields_do_not_overlap():
    fields = [stream(5, "CW", 1, name).random(1000) for name in ("a", "b", "c")]
    for one, other in itertools.combinations(fields, 2):
        assert not np.intersect1d(one, other).size
