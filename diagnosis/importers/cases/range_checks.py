"""Notes on range sensors of a drive whose room, mounts or columns are probably wrong."""

from collections.abc import Iterator, Mapping
from itertools import permutations
from math import degrees

import numpy as np

from diagnosis.measured.case_files.case_format import POSE, RANGE_SIDES
from diagnosis.measured.case_files.nominal import KnownRoom, Mount, NominalDrive
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CHECK, Measurement
from diagnosis.measured.room_distances import room_ranges
from symolo.core.arrays import Array

MAX_OUTSIDE = 0.1
"""Share of the poses outside of the room from which on its place is wrong; a tracker has fewer outliers."""
MIN_OUTSIDE_M = 0.02
"""Distance from the room from which on a pose is outside: the walls are not exact, nor is the tracker."""
MIN_READINGS = 20
"""Readings of each sensor from which its place on the robot is judged."""
BETTER = 4.0
"""Ratio of the median errors from which on the sensors are exchanged."""
MIN_ERROR_M = 0.05
"""Median error below which no sensor is at another place than its mount."""
MIN_OFF_M, MIN_OFF = 0.1, 0.15
"""Median error, in metres and as a share of the usual reading, from which on a sensor does not see the stated walls."""


def range_checks(nominal: NominalDrive, measurement: Measurement) -> Iterator[str]:
    """Yield a note if the poses are outside of the room, or if the readings fit the mounts of other sensors."""
    room, tof = nominal.world, nominal.tof
    if room is None or tof is None or not measurement.has(*POSE):
        return
    mounts = {side: getattr(tof.mount, side) for side in RANGE_SIDES if measurement.has(f"tof_{side}_m")}
    mounts = {side: mount for side, mount in mounts.items() if mount is not None}
    if not mounts:
        return
    outside = list(_outside(room, measurement))
    yield from outside or _misplaced(room, mounts, tof.max_range_m, measurement)


def _outside(room: KnownRoom, measurement: Measurement) -> Iterator[str]:
    x, y = (np.concatenate([trial[name].values for trial in measurement.trials]) for name in ("x_m", "y_m"))
    known = np.isfinite(x + y)
    x, y = x[known], y[known]
    beyond_m = np.maximum.reduce([-x, x - room.room_x_m, -y, y - room.room_y_m])
    outside = int(np.count_nonzero(beyond_m > MIN_OUTSIDE_M))
    if outside <= MAX_OUTSIDE * len(x):
        return
    (x_from, x_to), (y_from, y_to) = (np.quantile(column, (0.01, 0.99)).tolist() for column in (x, y))
    yield (
        f"{CHECK} x_m and y_m: {outside} of {len(x)} poses are outside of the room with 0 <= x <= {room.room_x_m:g} "
        f"and 0 <= y <= {room.room_y_m:g}; x goes from {x_from:.3g} to {x_to:.3g}, and y from {y_from:.3g} to "
        f"{y_to:.3g}; state where the corner of the room is in the frame of the log: give `symolo case init` --set "
        "room_corner_x_m and --set room_corner_y_m"
    )


def _misplaced(
    room: KnownRoom, mounts: Mapping[str, Mount], max_range_m: float, measurement: Measurement
) -> Iterator[str]:
    """Yield a note if the readings fit the mounts of other sensors, or else one for each that fits no wall."""
    readings = {side: _readings(measurement, side, max_range_m) for side in mounts}
    seen = {side: _distances(room, mounts[side], measurement) for side in mounts}
    # A camera may log poses in other rows than those of the readings.
    sides = [side for side in mounts if np.isfinite(readings[side] + seen[side]).sum() >= MIN_READINGS]
    error_m = {
        (side, at): float(np.nanmedian(np.abs(readings[side] - np.minimum(seen[at], max_range_m))))
        for side in sides
        for at in sides
    }
    orders = [tuple(zip(sides, order, strict=True)) for order in permutations(sides)]
    largest_m = [max((error_m[pair] for pair in order), default=0.0) for order in orders]
    best = int(np.argmin(largest_m))
    if largest_m[0] < MIN_ERROR_M:
        return
    if BETTER * largest_m[best] < largest_m[0]:
        wrong = [(side, at) for side, at in orders[best] if side != at]
        names = " and ".join(f"tof_{side}_m" for side, _ in wrong)
        fits = " and ".join(f"the readings of tof_{side}_m fit the mount of {at}" for side, at in wrong)
        yield (
            f"{CHECK} {names}: {fits}, with a median error of {largest_m[best]:.2g} m in place of {largest_m[0]:.2g} "
            "m; exchange the columns or the mounts"
        )
        return
    for side in sides:
        off_m = error_m[side, side]
        if off_m <= max(MIN_OFF_M, MIN_OFF * float(np.nanmedian(readings[side]))):
            continue
        yaw_rad = mounts[side].yaw_rad
        turned = mounts[side].model_copy(update={"yaw_rad": degrees(yaw_rad)})
        turned_m = np.nanmedian(np.abs(readings[side] - np.minimum(_distances(room, turned, measurement), max_range_m)))
        cure = "check the mount of this sensor, room_x_m, room_y_m, and the corner of the room"
        if BETTER * turned_m < off_m:
            cure = f"its yaw of {degrees(yaw_rad):.4g} degrees fits as radians: write {degrees(degrees(yaw_rad)):.0f}"
        yield (
            f"{CHECK} tof_{side}_m: half of the readings differ from the distance to the wall by more than {off_m:.2g} "
            f"m; {cure}"
        )


def _readings(measurement: Measurement, side: str, max_range_m: float) -> Array:
    """Return the readings (N,) of a sensor within its reach, NaN in other rows."""
    channels = measurement.across(f"tof_{side}_m")
    readings_m = np.concatenate([channel.values for channel in channels])
    good = np.concatenate([channel.quality == SampleQuality.GOOD for channel in channels])
    return np.where(good & (readings_m > 0.0) & (readings_m < max_range_m), readings_m, np.nan)


def _distances(room: KnownRoom, mount: Mount, measurement: Measurement) -> Array:
    """Return the distances (N,) to the walls that a sensor at this mount sees from the logged poses [m]."""
    pose = np.column_stack([np.concatenate([c.values for c in measurement.across(name)]) for name in POSE])
    x_m, y_m, yaw_rad = (np.array([value]) for value in (mount.x_m, mount.y_m, mount.yaw_rad))
    return room_ranges(room, pose, x_m, y_m, yaw_rad).distance_m[:, 0]
