"""Heading of an upright body from the quaternion of its orientation."""

from collections.abc import Sequence

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.geometry.poses import rotations

MAX_OFF_LENGTH = 0.1
"""Largest difference of the usual length of a quaternion from 1."""
MAX_USUAL_TILT_RAD = np.radians(30.0)
"""Largest usual tilt of a body whose x axis gives a heading."""
NOTABLE_TILT_RAD = np.radians(5.0)
NEARLY_ZERO = 0.1
"""Largest size of the components about x and y of a body that is upright, which is that of a tilt of 11 degrees."""


def heading_of(components: Array, where: str, names: Sequence[str]) -> Array:
    """Return the direction of the x axis on the floor [rad] (N,), in -pi to pi; NaN where a component is missing.

    Args:
        components: (N, 4), x, y, z, w, or (N, 2), z, w of a turn about z.
        where: Place of the log for messages.
        names: Names of the columns.

    Raises:
        InputError: The components are no quaternion, or the body is usually tilted.
    """
    R_WB, known = _rotations(components, where, names)
    heading = np.full(len(components), np.nan)
    heading[known] = np.arctan2(R_WB[:, 1, 0], R_WB[:, 0, 0])
    return heading


def tilt_note(components: Array, where: str, names: Sequence[str]) -> str:
    """Return a sentence on the tilt of a body; empty if it is hardly tilted.

    Raises:
        InputError: The components are no quaternion, or the body is usually tilted.
    """
    largest_rad = float(_tilts_rad(_rotations(components, where, names)[0]).max(initial=0.0))
    tilt = f"; tilts of up to {np.degrees(largest_rad):.0f} degrees are left out"
    return f"direction of the body's x axis{tilt}" if largest_rad > NOTABLE_TILT_RAD else ""


def ordered(components: Array, names: Sequence[str], where: str) -> tuple[str, ...]:
    """Return the names of q0 to q3 in the order x, y, z, w, by the components that stay near 0 for an upright body.

    Raises:
        InputError: The values do not show the order.
    """
    sizes = np.nanmax(np.abs(components), axis=0, initial=0.0)
    real_first, real_last = (bool((sizes[about] < NEARLY_ZERO).all()) for about in ([1, 2], [0, 1]))
    q0, q1, q2, q3 = names
    if real_first != real_last:
        return (q1, q2, q3, q0) if real_first else (q0, q1, q2, q3)
    line = "theta_rad: {quaternion: [%s]}"
    first, last = (line % ", ".join(order) for order in ((q1, q2, q3, q0), names))
    raise InputError(
        f"{', '.join(names)}: the values do not show which one is the real part of the quaternion",
        where=where,
        cure=f"name them in the order x, y, z, w in a mapping file: {first} if {q0} is the real part, {last} if {q3}",
    )


def _rotations(components: Array, where: str, names: Sequence[str]) -> tuple[Array, Array]:
    """Return the rotations (M, 3, 3) of the rows whose components are all known, and which rows (N,) these are.

    Raises:
        InputError: The components are no quaternion, or the body is usually tilted.
    """
    if components.shape[1] == 2:
        components = np.column_stack((np.zeros((len(components), 2)), components))
    lengths = np.linalg.norm(components, axis=1)
    known = np.isfinite(lengths) & (lengths > 0.0)
    usual = float(np.median(lengths[known])) if known.any() else 0.0
    if abs(usual - 1.0) > MAX_OFF_LENGTH:
        what = f"{', '.join(names)}: no quaternion, since its length is usually {usual:.3g}"
        raise InputError(what, where=where, allowed="1", cure="name the columns of its components x, y, z and w")
    R_WB = rotations(components[known])
    tilts_rad = _tilts_rad(R_WB)
    if len(tilts_rad) and (usual_rad := float(np.median(tilts_rad))) > MAX_USUAL_TILT_RAD:
        raise InputError(
            f"{', '.join(names)}: the z axis of the body is usually tilted by {np.degrees(usual_rad):.0f} degrees",
            where=where,
            cure="check that the columns are those of x, y, z and w, in this order; of a body with other axes, such as "
            "a camera, write the heading of the robot into a column of its own",
        )
    return R_WB, known


def _tilts_rad(R_WB: Array) -> Array:
    return np.arccos(np.clip(R_WB[:, 2, 2], -1.0, 1.0))
