"""Fingerprint of an arena, which shows whether two runs took place in the same one."""

import hashlib

import numpy as np

from symolo.arena.geometry import Arena
from symolo.core.files.file_hashes import canonical_json


def arena_fingerprint(arena: Arena) -> str:
    """Return the SHA-256 of the shapes of line, walls and obstacles, to a tenth of a millimetre.

    Colours and reflectances do not count: robots meet the same arena under another look.
    """
    edges = [side for pair in arena.line.edges() for side in pair]
    boxes = sorted(np.round(box.footprint(), 4).tolist() for box in arena.boxes)
    shapes = {"line": [(np.round(side, 4) + 0.0).tolist() for side in edges], "boxes": boxes}
    return hashlib.sha256(canonical_json(shapes)).hexdigest()
