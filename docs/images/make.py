"""Make every image of README.md and docs, except those of docs/reference, from a small release that it makes itself.

python docs/images/make.py WORKSPACE [--only NAME ...]

WORKSPACE is a folder for datasets and other files that are not kept; a second run continues from what is there.
The same code on the same class of processor writes the same images.
"""

import argparse
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from from_above import draw_arena, run_from_above
from matplotlib.figure import Figure
from PIL import Image
from robot_sizes import robots_beside_each_other

import symolo
from configs.draw import draw_run
from configs.loader import load_scenario
from physics.control.registry import CONTROLLERS
from pipeline.cli import main as symolo_command
from pipeline.gym.environment import DriveEnvironment
from pipeline.stages.simulate import simulate
from symolo.arena.geometry import Arena

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "diagnosis/examples"
SCENARIO = """\
extends: symolo
name: images
routes:
  - {name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}
rates: {camera_hz: 2}
stop: {lap: false, time_limit_s: 37.5}
render: {width_px: 320, height_px: 240, annotations: [depth, semantic, normals, flow]}
robot: robot.yaml
look: {extends: classroom, line: tape, floor: {material: parquet}}
"""
ROBOT = """\
extends: nominal
name: nominal_looking_ahead
camera: {pitch_down_deg: 14}  # sees more of the room than the shipped robot does
"""
WATCHING_ROBOT = """\
extends: nominal
name: watching_robot
sensors:
  left: {kind: camera, x_m: 0.06, y_m: 0.03, z_m: 0.12, pitch_up_deg: -25, width_px: 320, height_px: 240}
  right: {kind: camera, x_m: 0.06, y_m: -0.03, z_m: 0.12, pitch_up_deg: -25, width_px: 320, height_px: 240}
  rear: {kind: camera, x_m: -0.08, z_m: 0.1, yaw_deg: 180, period_s: 0.5, width_px: 320, height_px: 320, fisheye: {}}
"""
"""As in docs/sensors.md."""
LOOKS = {"classroom": 24, "lab": 3, "atelier": 31, "garage": 43, "night": 14, "extreme": 62}
"""The looks of the strip, each with the number of the image of the run whose place it shows."""
DRIVE = ("render.width_px=16", "render.height_px=16", "render.quality=draft", "render.annotations=[]")
"""Settings of a release whose images nobody looks at."""
ANNOTATED_IMAGE = 25
RANDOM_ARENAS = 5
FRAMES_PER_S = 8
"""Of the animation; images are taken at 2 Hz, so it runs at four times the speed."""


def strip(workspace: Path) -> None:
    """Write one image of each shipped look in two rows; each is rendered at another place of the run."""
    run = _drive(workspace)
    tiles = []
    for look, number in LOOKS.items():
        folder = workspace / f"strip_{look}"
        source = workspace / f"strip_{look}.csv"
        _save_rows(workspace / "drive/CW/test_1/data.csv", run.image(number).row, source)
        settings = ("--set", "render.width_px=320", "--set", "render.height_px=240")
        robot = workspace / "robot.yaml"
        _command("rerender", source, "--look", look, "--robot", robot, "--camera-hz", 5, "--out", folder, *settings)
        tiles.append(cv2.imread(str(folder / "imported/test_1/images/000001.jpg")))
    _save_jpeg("looks.jpg", np.vstack([np.hstack(tiles[:3]), np.hstack(tiles[3:])]))


def _save_rows(source: Path, first_row: int, path: Path) -> None:
    """Write the rows of one image at 5 Hz as a data.csv."""
    lines = source.read_text().splitlines()
    path.write_text("\n".join([lines[0], *lines[1 + first_row : 5 + first_row]]) + "\n")


def animation(workspace: Path) -> None:
    """Write what the camera sees beside the floor from above, with path and ranges so far."""
    run = _run(workspace)
    arena = Arena.from_config(run.spec.arena)
    frames = []
    for image in run.images:
        view = Image.fromarray(image.pixels())
        above = run_from_above(arena, run, image.row)
        frame = Image.new("RGB", (view.width + above.width, view.height), "white")
        frame.paste(view, (0, 0))
        frame.paste(above, (view.width, 0))
        frames.append(frame)
    frames[0].save(
        HERE / "run.webp", save_all=True, append_images=frames[1:], duration=round(1000 / FRAMES_PER_S), loop=0,
        quality=72, method=4,
    )  # fmt: skip


def _depth(image: symolo.Image) -> np.ndarray:
    """Return the depth of an image in colours, bright for near and black for no surface."""
    depth_m = image.annotation("depth").astype(float) / 10_000
    shades = (255 * (1 - np.clip(depth_m / 2.0, 0, 1))).astype(np.uint8)
    return np.where((depth_m > 0)[..., None], cv2.applyColorMap(shades, cv2.COLORMAP_VIRIDIS)[..., ::-1], 0)


def cameras(workspace: Path) -> None:
    """Write images of a stereo pair and of a fisheye lens at the rear above their depths."""
    robot = workspace / "watching_robot.yaml"
    robot.write_text(WATCHING_ROBOT)
    settings = (f"robot={robot}", "render.annotations=[depth]", "look=classroom", "stop.time_limit_s=0.1")
    settings += ("routes=[{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}]",)
    _command("release", "smoke", "--out", workspace / "cameras", *(f"--set={setting}" for setting in settings))
    images = [camera.image(1) for camera in symolo.load(workspace / "cameras")["CW/test_1"].cameras.values()]
    images = [images[0], images[2], images[1]]  # left, right, rear
    sizes = [(400, 300), (400, 300), (300, 300)]
    rows = [
        [cv2.resize(tile, size, interpolation=cv2.INTER_AREA) for tile, size in zip(tiles, sizes, strict=True)]
        for tiles in ([image.pixels() for image in images], [_depth(image).astype(np.uint8) for image in images])
    ]
    _save_jpeg("cameras.jpg", np.vstack([np.hstack(row) for row in rows])[..., ::-1])


def ros(workspace: Path) -> None:
    """Write what RViz shows of a bag; examples/open_in_ros.sh says which packages of ROS 1 this needs."""
    examples, bag = HERE.parents[1] / "examples", workspace / "ros/exported/ros1/CW/test_1.bag"
    _command("release", examples / "stereo_scout.yaml", "--out", workspace / "scout")
    shutil.rmtree(workspace / "ros", ignore_errors=True)
    _command("export", workspace / "scout", "--format", "ros1", "--out", workspace / "ros/exported")
    _command("model", examples / "stereo_scout.yaml", "--format", "urdf", "--out", workspace / "ros/model")
    script = [examples / "open_in_ros.sh", bag, workspace / "ros/model/robot.urdf", workspace / "ros/seen"]
    subprocess.run(list(map(str, script)), check=True)
    shown = cv2.imread(str(workspace / "ros/seen/rviz.png"))
    _save_jpeg("ros.jpg", cv2.resize(shown, (1000, 625), interpolation=cv2.INTER_AREA))


def annotations(workspace: Path) -> None:
    """Write one image beside its depth, semantic mask, normals and optical flow."""
    image = _run(workspace).image(ANNOTATED_IMAGE)
    depth = _depth(image)
    classes = image.annotation("semantic")
    palette = np.array([[130, 180, 235], [200, 200, 190], [20, 20, 20], [200, 120, 60], [150, 90, 170], [110, 130, 110],
                        [90, 90, 90]], dtype=np.uint8)  # fmt: skip
    normals = (image.annotation("normals") // 257).astype(np.uint8)
    flow = image.annotation("flow").astype(float)
    flow_px = np.where(flow[..., 2:] == 1, (flow[..., :2] - 32768) / 64, 0.0)
    angle_deg = np.degrees(np.arctan2(flow_px[..., 1], flow_px[..., 0])) % 360
    length = np.clip(np.hypot(*np.moveaxis(flow_px, -1, 0)) / 25, 0, 1)
    hsv = np.stack([angle_deg / 2, 255 * length, np.full_like(length, 255)], axis=-1).astype(np.uint8)
    tiles = [image.pixels(), depth.astype(np.uint8), palette[classes], normals, cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)]
    _save_jpeg("annotations.jpg", np.hstack([cv2.resize(tile, (240, 180)) for tile in tiles])[..., ::-1])


def arenas(_workspace: Path) -> None:
    """Write random arenas from above, each with the start of its run."""
    figure = Figure(figsize=(2.4 * RANDOM_ARENAS, 2.4), dpi=100)
    scenario = load_scenario("random_arenas", ())
    for number in range(1, RANDOM_ARENAS + 1):
        spec = draw_run(scenario, "Lap", number)
        axes = figure.add_axes(((number - 1) / RANDOM_ARENAS, 0.0, 1 / RANDOM_ARENAS, 1.0))
        draw_arena(axes, Arena.from_config(spec.arena))
        start = spec.start
        axes.plot(start.x_m, start.y_m, marker="o", color="#1f77b4", markersize=5)
        axes.set_aspect("equal")
        axes.margins(0.04)
        axes.axis("off")
    figure.savefig(HERE / "arenas.png", metadata={"Software": None})


def controllers(_workspace: Path) -> None:
    """Write the paths of the built-in controller, of one that follows the line, and of a random agent."""
    figure = Figure(figsize=(9.0, 3.0), dpi=100)
    for number, (name, path) in enumerate(_paths_of_controllers().items()):
        axes = figure.add_axes((number / 3, 0.0, 1 / 3, 0.9), title=name)
        draw_arena(axes, Arena.from_config(draw_run(load_scenario("smoke"), "CW", 1).arena))
        axes.plot(*path.T, color="#1f77b4", linewidth=1.5)
        axes.plot(*path[0], marker="o", color="#1f77b4", markersize=5)
        axes.set_aspect("equal")
        axes.margins(0.04)
        axes.axis("off")
    figure.savefig(HERE / "controllers.png", metadata={"Software": None})


def robots(_workspace: Path) -> None:
    """Write the shipped robots of three sizes beside each other."""
    _save_jpeg("robots.jpg", robots_beside_each_other())


def _paths_of_controllers() -> dict[str, np.ndarray]:
    """Return the path (N, 2) of each controller in the first 36 s of a lap, or until it touches something."""
    settings = ("stop.lap=false", "stop.time_limit_s=36")
    paths = {"built-in controller": simulate(draw_run(load_scenario("smoke", settings), "CW", 1))}
    example = CONTROLLERS.load(HERE.parents[1] / "examples/line_follower.py")
    paths["examples/line_follower.py"] = simulate(draw_run(load_scenario("smoke", settings), "CW", 1))
    by_name = {name: outcome.recording.trajectory.pose[:, :2] for name, outcome in paths.items()}
    CONTROLLERS.unload(CONTROLLERS.files[example.name])
    environment = DriveEnvironment("smoke", settings)
    environment.action_space.seed(1)
    poses = [environment.reset(seed=1)[1]["pose"]]
    over = False
    while not over:
        _, _, terminated, truncated, info = environment.step(environment.action_space.sample())
        poses.append(info["pose"])
        over = terminated or truncated
    environment.close()
    return {**by_name, "random agent": np.array(poses)[:, :2]}


def meshes(workspace: Path) -> None:
    """Write an image of the example with meshes beside its instances."""
    out = workspace / "meshes"
    _command("release", HERE.parents[1] / "examples/meshes.yaml", "--out", out, "--set", "render.samples=16")
    image = cv2.imread(str(out / "CW/test_1/images/000001.jpg"))
    number = cv2.imread(str(out / "CW/test_1/annotations/instance/000001.png"), cv2.IMREAD_UNCHANGED)
    shades = np.array([(37 * n % 200 + 40, 91 * n % 200 + 40, 149 * n % 200 + 40) for n in range(256)], np.uint8)
    _save_jpeg("meshes.jpg", np.hstack([image, shades[number % 256]]))


def preview(workspace: Path) -> None:
    """Write the sheet of a preview."""
    sheet = workspace / "preview.jpg"
    _command("preview", "symolo", "-n", 12, "--look", "classroom,lab,night,garage", "--out", sheet)
    pixels = cv2.imread(str(sheet))
    scale = 1200 / pixels.shape[1]
    _save_jpeg("preview.jpg", cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))


def baselines(workspace: Path) -> None:
    """Write the plot of localisation methods on a worn robot."""
    _command("simulate", "symolo", "--set", "robot=worn", "--set", "routes.0.runs=1", "--set", "routes.1.runs=1",
             "--out", workspace / "worn")  # fmt: skip
    _remake("baselines", workspace / "worn", workspace / "worn_baselines", "--runs", "CCW/*")
    _save_smaller("baselines.png", workspace / "worn_baselines/baselines.png", 1000)


def diagnosis(workspace: Path) -> None:
    """Write the plot of the misfit from the diagnosis of a motor on a bench."""
    _remake("diagnose", EXAMPLES / "motor_steady_002", workspace / "diagnosis")
    _save_smaller("diagnosis.png", workspace / "diagnosis/plots/current_A.png", 1200)


def predictive(workspace: Path) -> None:
    """Write the plot of the posterior predictive check of a drive."""
    _remake("diagnose", EXAMPLES / "drive_log_001", workspace / "predictive")
    _save_smaller("predictive.png", workspace / "predictive/plots/predictive.png", 1200)


def reliability(workspace: Path) -> None:
    """Write the diagram of stated confidences from 1,000 independent benches, which take half an hour."""
    repository, cases, answers = HERE.parents[1], workspace / "benches", workspace / "benches_answers"
    for kind in ("motor_steady", "tof_bench"):
        make = ["-m", "benchmarks.diagnosis.independent_cases", "--kind", kind, "--cases=500", "--seed=9101"]
        subprocess.run([sys.executable, *make, f"--out={cases.absolute()}"], check=True, cwd=repository)
    _command("diagnose", *sorted(path.parent for path in cases.glob("*/nominal.yaml")), "--out", answers)
    script, diagram = repository / "benchmarks/diagnosis/evaluations/reliability.py", workspace / "reliability.png"
    files = [f"--truth={cases / 'truth.json'}", f"--answers={answers}", f"--out={diagram}"]
    subprocess.run([sys.executable, script, *files], check=True)
    _save_smaller("reliability.png", diagram, 780)


def _remake(command: str, source: Path, out: Path, *options: str) -> None:
    shutil.rmtree(out, ignore_errors=True)
    _command(command, source, "--out", out, *options)


def _save_smaller(name: str, source: Path, width_px: int) -> None:
    with Image.open(source) as image:
        height_px = round(image.height * width_px / image.width)
        smaller = image.convert("RGB").resize((width_px, height_px), Image.Resampling.LANCZOS)
    smaller.quantize(64, dither=Image.Dither.NONE).save(HERE / name, optimize=True)


def _save_jpeg(name: str, pixels: np.ndarray) -> None:
    cv2.imwrite(str(HERE / name), pixels, [cv2.IMWRITE_JPEG_QUALITY, 82])


@cache
def _run(workspace: Path) -> symolo.Run:
    """Return the run that most images show, after releasing it."""
    return _released(workspace, "release")


def _drive(workspace: Path) -> symolo.Run:
    """Return the same run with tiny images, which are not shown."""
    return _released(workspace, "drive", *DRIVE)


def _released(workspace: Path, name: str, *settings: str) -> symolo.Run:
    scenario = workspace / "images.yaml"
    scenario.write_text(SCENARIO)
    (workspace / "robot.yaml").write_text(ROBOT)
    _command("release", scenario, "--out", workspace / name, *(f"--set={setting}" for setting in settings))
    return symolo.load(workspace / name)["CW/test_1"]


def _command(*words: object) -> None:
    code = symolo_command([str(word) for word in words])
    if code:
        raise SystemExit(f"symolo {' '.join(map(str, words))}: exit code {code}")


IMAGES: dict[str, Callable[[Path], None]] = {
    "strip": strip,
    "run": animation,
    "annotations": annotations,
    "cameras": cameras,
    "arenas": arenas,
    "controllers": controllers,
    "robots": robots,
    "meshes": meshes,
    "preview": preview,
    "baselines": baselines,
    "diagnosis": diagnosis,
    "predictive": predictive,
    "reliability": reliability,
    "ros": ros,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("workspace", type=Path)
    parser.add_argument("--only", nargs="+", choices=IMAGES, default=list(IMAGES))
    arguments = parser.parse_args()
    arguments.workspace.mkdir(parents=True, exist_ok=True)
    for name in arguments.only:
        IMAGES[name](arguments.workspace.resolve())


if __name__ == "__main__":
    main()
