"""A black line on a pale floor, seen by a camera on a robot: rays to the floor, many in each pixel.

The line is straight, bends to the left by a quarter, and is straight again. The robot drives along it, a little beside
it and swaying.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import gaussian_filter

LINE_WIDTH_M = 0.015
RADIUS_M = 0.25
LEG_M = 0.6
FLOOR, TAPE = np.array([0.52, 0.5, 0.46]), np.array([0.03, 0.03, 0.032])
"""Reflectances, red, green, blue."""


@dataclass(frozen=True)
class Lens:
    focal_px_per_width: float = 30 / 42.33
    k1: float = 0.0
    right: float = 0.0
    down: float = 0.0
    """Of the optical axis from the middle, in widths of the image."""


@dataclass(frozen=True)
class Camera:
    pitch_deg: float = 30.0
    yaw_deg: float = 0.0
    roll_deg: float = 0.0
    x_m: float = 0.05
    y_m: float = 0.0
    z_m: float = 0.12
    lens: Lens = field(default_factory=Lens)


@dataclass(frozen=True)
class Hidden:
    """What the images have that is no matter of geometry."""

    gain: float = 1.0
    red: float = 1.0
    blue: float = 1.0
    vignetting: float = 0.2
    """Share of light lost in the corner."""
    glare: float = 0.0
    blur_px: float = 0.4
    exposure_s: float = 0.0
    sharpening: float = 0.0
    shot_noise: float = 0.012
    read_noise: float = 0.003
    late_s: float = 0.0
    read_out_s: float = 0.0


def track_yaml():
    """The line in the fields of an arena file."""
    end = [LEG_M + RADIUS_M, RADIUS_M]
    return {
        "name": "bend",
        "line": {
            "width_m": LINE_WIDTH_M,
            "pieces": [
                {"kind": "straight", "start": [-0.3, 0.0], "end": [LEG_M, 0.0]},
                {
                    "kind": "arc",
                    "center": [LEG_M, RADIUS_M],
                    "radius_m": RADIUS_M,
                    "start_deg": -90.0,
                    "end_deg": 0.0,
                },
                {"kind": "straight", "start": end, "end": [end[0], end[1] + LEG_M]},
            ],
        },
    }


def poses(t_s, speed=0.15):
    """x [m], y [m], yaw [rad], speed [m/s] and yaw rate [rad/s] at times (N,): along the line, swaying."""
    t_s = np.asarray(t_s, float)

    def at(t):
        s = speed * t
        bend = RADIUS_M * np.pi / 2
        turned = np.clip((s - LEG_M) / bend, 0, 1) * np.pi / 2
        x = np.minimum(s, LEG_M) + RADIUS_M * np.sin(turned)
        y = RADIUS_M * (1 - np.cos(turned)) + np.maximum(s - LEG_M - bend, 0)
        aside = 0.01 * np.sin(3.0 * t)
        return np.stack([x - aside * np.sin(turned), y + aside * np.cos(turned), turned], -1)

    # Heading is that of the line plus the sway's, so that it has no jump where the bend begins.
    sway, swaying = 0.03 * np.cos(3.0 * t_s) / speed, -0.09 * np.sin(3.0 * t_s) / speed
    here = at(t_s)
    bending = (here[:, 2] > 0) & (here[:, 2] < np.pi / 2)
    rate = np.where(bending, speed / RADIUS_M, 0.0) + swaying / (1 + sway**2)
    return np.column_stack([here[:, :2], here[:, 2] + np.arctan(sway), speed * np.hypot(1, sway), rate])


def covered(x, y):
    """Whether floor points lie on the line."""
    half = LINE_WIDTH_M / 2
    first = (np.abs(y) <= half) & (x >= -0.3) & (x <= LEG_M)
    ring = np.abs(np.hypot(x - LEG_M, y - RADIUS_M) - RADIUS_M) <= half
    second = ring & (x >= LEG_M) & (y <= RADIUS_M)
    end = LEG_M + RADIUS_M
    third = (np.abs(x - end) <= half) & (y >= RADIUS_M) & (y <= RADIUS_M + LEG_M)
    return first | second | third


def light(camera, pose, size, times=None):
    """(H, W, 3) linear light; `times` is a list of poses over which it is averaged."""
    if times is not None:
        return np.mean([light(camera, one, size) for one in times], axis=0)
    width, height = size
    n = 3
    u = (np.arange(width * n) + 0.5) / n - 0.5
    v = (np.arange(height * n) + 0.5) / n - 0.5
    uu, vv = np.meshgrid(u, v)
    if np.ndim(pose[0]) > 0:  # a pose for each row
        pose = [np.repeat(p, n)[:, None] for p in pose]
    floor_x, floor_y, seen = to_floor(camera, pose, size, uu, vv)
    on = covered(floor_x, floor_y) & seen
    texture = (
        1 + 0.04 * np.sin(31 * floor_x + 4) * np.sin(27 * floor_y + 1) + 0.02 * np.sin(90 * floor_x + 70 * floor_y)
    )
    image = np.where(on[..., None], TAPE, FLOOR * np.where(seen, texture, 1.0)[..., None])
    image = np.where(seen[..., None], image, 0.35)
    return image.reshape(height, n, width, n, 3).mean(axis=(1, 3))


def to_floor(camera, pose, size, u, v):
    """Floor points that pixels see, and whether they see the floor at all."""
    width, height = size
    lens = camera.lens
    f = lens.focal_px_per_width * width
    xd = (u - (width - 1) / 2 - lens.right * width) / f
    yd = (v - (height - 1) / 2 - lens.down * width) / f
    x, y = xd, yd
    for _ in range(12 if lens.k1 else 0):
        scale = 1 + lens.k1 * (x * x + y * y)
        x, y = xd / scale, yd / scale
    roll, pitch, yaw = np.radians([camera.roll_deg, camera.pitch_deg, camera.yaw_deg])
    right = x * np.cos(roll) - y * np.sin(roll)
    down = x * np.sin(roll) + y * np.cos(roll)
    ahead = np.cos(pitch) - down * np.sin(pitch)
    up = -np.sin(pitch) - down * np.cos(pitch)
    a = ahead * np.cos(yaw) + right * np.sin(yaw)
    b = ahead * np.sin(yaw) - right * np.cos(yaw)
    seen = up < -0.02
    far = camera.z_m / np.where(seen, -up, 1.0)
    robot_x, robot_y = camera.x_m + far * a, camera.y_m + far * b
    px, py, heading = pose
    c, s = np.cos(heading), np.sin(heading)
    return px + c * robot_x - s * robot_y, py + s * robot_x + c * robot_y, seen


def image(camera, t_s, size=(160, 120), hidden=None, seed=0):
    """(H, W, 3) 8-bit RGB of the camera at a time of the drive."""
    hidden = hidden or Hidden()
    width, height = size

    def pose_at(t):
        if hidden.read_out_s:
            t = t + ((np.arange(height) + 0.5) / height - 0.5) * hidden.read_out_s
        found = poses(np.atleast_1d(t + hidden.late_s))[:, :3].T
        return tuple(found) if hidden.read_out_s else tuple(float(p[0]) for p in found)

    moments = [pose_at(t_s + hidden.exposure_s * k) for k in np.linspace(-0.45, 0.45, 9)] if hidden.exposure_s else None
    lin = light(camera, pose_at(t_s), size, moments)
    lin = np.stack([gaussian_filter(lin[..., k], hidden.blur_px, mode="nearest") for k in range(3)], -1)
    lin = lin + hidden.glare * (lin.mean(axis=(0, 1)) - lin)
    yy, xx = np.mgrid[:height, :width]
    r2 = ((xx - (width - 1) / 2) ** 2 + (yy - (height - 1) / 2) ** 2) / ((width / 2) ** 2 + (height / 2) ** 2)
    lin = lin * (1 - hidden.vignetting * r2)[..., None] * 0.5 * hidden.gain
    rng = np.random.default_rng([seed, int(1000 * t_s)])
    lin = lin + rng.normal(size=lin.shape) * np.sqrt(hidden.shot_noise**2 * lin + hidden.read_noise**2)
    lin = np.maximum(lin, 0) * (hidden.red, 1.0, hidden.blue)
    # The transfer of IEC 61966-2-1, with a shoulder from 0.6 on.
    over = np.maximum(lin - 0.6, 0)
    lin = np.where(over > 0, 1 - 0.4 * np.exp(-over / 0.4), lin)
    coded = np.where(lin <= 0.0031308, 12.92 * lin, 1.055 * np.maximum(lin, 1e-9) ** (1 / 2.4) - 0.055)
    if hidden.sharpening:
        grey = coded @ (0.299, 0.587, 0.114)
        coded = coded + hidden.sharpening * (grey - gaussian_filter(grey, 1.0, mode="mirror"))[..., None]
    return (255 * np.clip(coded, 0, 1) + 0.5).astype(np.uint8)
