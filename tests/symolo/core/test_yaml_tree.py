import pytest

from symolo.core.yaml.tree import merge, node_of

ARC = {"kind": "arc", "center": [0, 0], "radius_m": 1}


@pytest.mark.parametrize(
    ("base", "over", "merged"),
    [
        ({"a": {"b": 1, "c": 2}}, {"a": {"c": 3}}, {"a": {"b": 1, "c": 3}}),
        ({"a": [1, 2, 3]}, {"a": [4]}, {"a": [4]}),
        ({"a": {"b": 1}}, {"a": 2}, {"a": 2}),
        ({"a": 2}, {"a": {"b": 1}}, {"a": {"b": 1}}),
        ({"a": {"uniform": [0, 1]}}, {"a": {"normal": [0, 1]}}, {"a": {"normal": [0, 1]}}),
        (ARC, {"radius_m": 2}, {**ARC, "radius_m": 2}),
        (ARC, {"kind": "arc", "radius_m": 2}, {**ARC, "radius_m": 2}),
        (ARC, {"kind": "straight", "start": [0, 0]}, {"kind": "straight", "start": [0, 0]}),
    ],
)
def test_what_lies_over_wins_and_mappings_of_one_kind_merge(base: object, over: object, merged: object):
    assert merge(node_of(base, "base:1"), node_of(over, "over:1")).plain() == merged


def test_merged_values_keep_their_own_places():
    merged = merge(node_of({"a": 1, "b": 2}, "base:1"), node_of({"b": 3}, "over:1"))
    assert {key: node.where for key, node in merged.children()} == {"a": "base:1", "b": "over:1"}
