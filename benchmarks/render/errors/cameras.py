"""Further cameras against geometry: depth of a rectified stereo pair by OpenCV, and the line behind a fisheye lens.

    python -m benchmarks.render.errors.cameras

It makes two short runs from a config alone, with a stereo pair and a fisheye lens at the rear, and prints

- the disparity of the pair by OpenCV's semi-global matching beside that of the annotated depth of the left camera, and
  the shift that is left between the pair after the annotated depth, where the image has edges;
- the distance of the edges of the line in the fisheye images from the edges of the arena, projected by the intrinsics
  and poses that the release holds.

The line is painted, because a tape 0.13 mm thick has a shade beside it, and the camera has no noise.
"""

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

import symolo
from pipeline.cli import main
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import project
from symolo.reader.camera_run import CameraRun

BASELINE_M = 0.06
PAIR = "kind: camera, x_m: 0.06, z_m: 0.15, pitch_up_deg: -25, width_px: 480, height_px: 360, annotations: [depth]"
REAR = "kind: camera, x_m: -0.08, z_m: 0.1, yaw_deg: 180, pitch_up_deg: -20, width_px: 640, height_px: 640"
SETTINGS = (
    f"robot.sensors.left={{{PAIR}, y_m: {0.5 * BASELINE_M}}}",
    f"robot.sensors.right={{{PAIR}, y_m: {-0.5 * BASELINE_M}}}",
    f"robot.sensors.rear={{{REAR}, fisheye: {{k1: 0.02, k2: -0.005}}}}",
    "stop.time_limit_s=0.1",
    "render.width_px=32",
    "render.height_px=24",
    "look.floor.material=plywood",
    "look.floor.stains=0.6",
    "look.floor.dirt=0",
    "look.line=paint",
    "look.line_paint.wear=0",
    *(f"look.camera.{name}=0" for name in ("shot_noise", "read_noise", "vignetting", "sharpening")),
    "look.camera.contrast=1",
)
DISPARITIES = 160
MATCHING = 7
"""Size of the blocks that are matched [px]."""
EDGE = 4.0
"""Smallest slope of the grey value per pixel where the shift between the images is measured."""
REACH_PX = 6


@dataclass(frozen=True)
class Pair:
    """Two images of a rectified pair, as grey values, and the disparity of the annotated depth."""

    left: np.ndarray
    right: np.ndarray
    depth_m: np.ndarray
    disparity_px: np.ndarray

    @property
    def seen(self) -> np.ndarray:
        """(H, W), pixels of the left image that have a depth and are within the right image."""
        u = np.arange(self.left.shape[1])
        return (self.depth_m > 0) & (u - self.disparity_px > 2) & (self.disparity_px < DISPARITIES - 1)

    def matching_errors(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the depth [m] and the error of the disparity [px] of the pixels that OpenCV matches."""
        penalty = 3 * MATCHING**2
        matcher = cv2.StereoSGBM.create(
            0, DISPARITIES, MATCHING, 8 * penalty, 32 * penalty, 1, uniquenessRatio=10, mode=cv2.STEREO_SGBM_MODE_HH
        )
        disparity_px = matcher.compute(self.left, self.right).astype(np.float64) / 16
        matched = self.seen & (disparity_px > 0)
        return self.depth_m[matched], (disparity_px - self.disparity_px)[matched]

    def shift_px(self) -> float:
        """Return how far the right image is from the left one after the annotated disparity (Lucas and Kanade 1981)."""
        v, u = np.indices(self.left.shape, dtype=np.float32)
        moved = cv2.remap(self.right, u - self.disparity_px.astype(np.float32), v, cv2.INTER_LINEAR)
        left, moved = (cv2.GaussianBlur(image.astype(np.float32), (0, 0), 1.0) for image in (self.left, moved))
        slope = cv2.Sobel(moved, cv2.CV_32F, 1, 0) / 8
        # Large differences are reflections and what only one camera sees.
        edges = self.seen & (abs(slope) > EDGE) & (abs(left - moved) < 30)
        return float(((left - moved) * slope)[edges].sum() / (slope * slope)[edges].sum())


def pairs_of(left: CameraRun, right: CameraRun) -> Iterator[Pair]:
    focal_px = left.camera.K[0][0]
    for one, other in zip(left.images, right.images, strict=True):
        depth_m = one.annotation("depth") / 1e4
        grey = [cv2.cvtColor(image.pixels(), cv2.COLOR_RGB2GRAY) for image in (one, other)]
        yield Pair(*grey, depth_m, focal_px * BASELINE_M / np.maximum(depth_m, 1e-3))


def line_errors(camera: CameraRun) -> Iterator[float]:
    """Yield the distance [px] of each point of the line's edges in the images from where the model projects it."""
    arena = Arena.from_config(camera.whole.spec.arena)
    model, half_m = camera.camera.intrinsics, 0.5 * arena.line.width_m
    for image in camera.images:
        linear = (cv2.cvtColor(image.pixels(), cv2.COLOR_RGB2GRAY) / 255.0) ** 2.2
        for piece in arena.line.pieces:
            s = np.arange(0.006, piece.length_m - 0.006, 0.005)
            for sign in (1, -1):
                on, out = (
                    np.column_stack([piece.at(s, sign * (half_m + beside)), np.zeros(len(s))])
                    for beside in (0.0, 0.004)
                )
                (pixel, _), (further, _) = project(model, image.X_WC, on), project(model, image.X_WC, out)
                outward = further - pixel
                length = np.linalg.norm(outward, axis=1)
                # The line is then at least 15 px wide, so that the profile stays on it.
                for at, ray in zip(pixel[length > 4.0], (outward / length[:, None])[length > 4.0], strict=True):
                    if np.all((at > 10) & (at < np.array([model.width_px, model.height_px]) - 11)):
                        yield _offset(linear, at, ray)


def _offset(image: np.ndarray, at: np.ndarray, outward: np.ndarray) -> float:
    """Return how far outwards the step from the dark line to the bright floor is, by the area under it."""
    u, v = (at + outward * np.arange(-REACH_PX, REACH_PX + 0.01, 0.5)[:, None]).astype(np.float32).T
    profile = cv2.remap(image.astype(np.float32), u[:, None], v[:, None], cv2.INTER_LINEAR)[:, 0]
    dark, bright = profile[:5].mean(), profile[-5:].mean()
    return 0.5 * (0.5 * (len(profile) - 1) - ((profile - dark) / (bright - dark)).sum() + 0.5)


def report(root: Path) -> None:
    """Print the figures of a release."""
    runs = list(symolo.load(root))
    pairs = [pair for run in runs for pair in pairs_of(run.cameras["left"], run.cameras["right"])]
    depth_m, error_px = (np.concatenate(part) for part in zip(*(pair.matching_errors() for pair in pairs), strict=True))
    print(
        f"stereo: {len(pairs)} pairs, {len(depth_m)} matched pixels, {depth_m.min():.2f} to {depth_m.max():.2f} m deep"
    )
    print(
        f"  error of the disparity: median {np.median(error_px):+.3f} px, of its size {np.median(abs(error_px)):.3f} px"
    )
    print(f"  within 1 px: {100 * np.mean(abs(error_px) < 1):.1f} %")
    true = runs[0].cameras["left"].camera.K[0][0] * BASELINE_M / depth_m
    for low, high in ((0.1, 0.3), (0.3, 0.6), (0.6, 1.2), (1.2, 2.4)):
        there = (depth_m >= low) & (depth_m < high)
        share = abs(true / (true + error_px) - 1)[there]
        if len(share):
            print(f"  depth {low} to {high} m: median error {100 * np.median(share):.2f} % of {len(share)} pixels")
    print(
        f"  shift between the images after the annotated depth: {', '.join(f'{p.shift_px():+.3f}' for p in pairs)} px"
    )
    lines = np.array([error for run in runs for error in line_errors(run.cameras["rear"])])
    print(f"fisheye: {len(lines)} points of the line's edges")
    print(f"  median {np.median(lines):+.3f} px, of its size {np.median(abs(lines)):.3f} px")
    print(
        f"  within 0.5 px: {100 * np.mean(abs(lines) < 0.5):.1f} %, 95 % within {np.quantile(abs(lines), 0.95):.2f} px"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--release", type=Path, help="release of an earlier call, which is measured again")
    parser.add_argument("--out", type=Path, help="folder for the release; by default it is removed in the end")
    chosen = parser.parse_args()
    if chosen.release:
        report(chosen.release)
    else:
        with tempfile.TemporaryDirectory() as scratch:
            folder = chosen.out or Path(scratch) / "data"
            overrides = [f"--set={setting}" for setting in SETTINGS]
            if code := main(["release", "smoke", "--out", str(folder), *overrides]):
                raise SystemExit(code)
            report(folder)
