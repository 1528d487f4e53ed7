"""Columns of a SyMoLo data.csv by the channels that they become in a measurement."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.case_files.case_format import POSE
from symolo.dataset.tables.rows import LINE, RANGES

POSES: Mapping[str, str] = MappingProxyType(dict(zip(POSE, ("x", "y", "theta"), strict=True)))
SPEEDS: Mapping[str, str] = MappingProxyType({"v_m_s": "v", "w_rad_s": "w"})
RANGE_READINGS: Mapping[str, str] = MappingProxyType(
    dict(zip(("tof_front_m", "tof_left_m", "tof_right_m"), (column.name for column in RANGES.columns), strict=True))
)
LINE_READINGS: Mapping[str, str] = MappingProxyType({f"line_{k}": c.name for k, c in enumerate(LINE.columns)})
COLUMN_OF: Mapping[str, str] = MappingProxyType({**POSES, **SPEEDS, **RANGE_READINGS, **LINE_READINGS})
"""Column of every channel with readings, in the order of the columns."""
