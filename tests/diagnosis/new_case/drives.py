"""A drive by closed forms, as the table of a log."""

import numpy as np

DT, TICKS, RADIUS, TRACK = 0.05, 1440, 0.0325, 0.14
R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 0.003
"""A robot whose motors obey u = R i + K w and K i = B w + Tc sgn(w) + J w'."""
SLOPE = K + R * B / K


def smooth(t, phase):
    """Speed [rad/s] of a wheel that never stands still, and its derivative."""
    return 8 + 3 * np.sin(1.3 * t + phase), 3.9 * np.cos(1.3 * t + phase)


def drive_rows(t):
    """Columns of a drive by closed forms: ticks are integrals of the speeds, and the pose follows by small steps."""
    rng = np.random.Generator(np.random.PCG64(5))
    fine = np.arange(0.0, t[-1] + DT, 1e-3)
    turned = {}
    for side, phase in (("l", 0.0), ("r", 1.0)):
        turned[side] = 8 * fine - 3 / 1.3 * (np.cos(1.3 * fine + phase) - np.cos(phase))
    heading = RADIUS * (turned["r"] - turned["l"]) / TRACK
    way = RADIUS * (turned["r"] + turned["l"]) / 2
    x, y = (np.cumsum(np.diff(way, prepend=0.0) * turn(heading)) for turn in (np.cos, np.sin))
    rows = np.searchsorted(fine, t - 1e-6)
    columns = {"time_ms": np.round(1e3 * t).astype(int)}
    for side, phase in (("l", 0.0), ("r", 1.0)):
        speed, slope = smooth(t + DT / 2, phase)
        columns[f"enc_{side}"] = np.floor(TICKS / 2 / np.pi * turned[side][rows]).astype(int)
        columns[f"motor_{side} [mV]"] = np.round(1e3 * (SLOPE * speed + R / K * (TC + J * slope)), 1)
    columns["x_cm"] = np.round(100 * (1 + x[rows] + rng.normal(0, 1e-3, len(t))), 3)
    columns["y_cm"] = np.round(100 * (1 + y[rows] + rng.normal(0, 1e-3, len(t))), 3)
    wrapped = np.angle(np.exp(1j * (heading[rows] + rng.normal(0, 3e-3, len(t)))))
    columns["heading_deg"] = np.round(np.degrees(wrapped), 3)
    return columns


def csv_text(columns):
    return (
        "\n".join([",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]) + "\n"
    )
