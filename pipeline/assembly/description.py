"""README.md of a dataset: what a person needs to use it, written from its metadata."""

import math
from collections.abc import Collection, Mapping
from types import MappingProxyType

from configs.schema.appearance.camera_look import ColourFilter
from configs.schema.arena import Obstacle
from configs.schema.robot import Camera, RobotConfig
from configs.schema.scenario import SceneSpec
from pipeline.stages.cameras import cameras_of
from symolo.core.geometry.lens import coefficients
from symolo.core.progress import plural
from symolo.dataset.annotations import DOCUMENT, ENCODINGS
from symolo.dataset.documents.camera_model import INTRINSICS
from symolo.dataset.documents.contents import LAYOUT, Contents
from symolo.dataset.documents.description import (
    columns_part,
    frames_part,
    markdown_table,
    plain_text,
    runs_part,
    splits_part,
)
from symolo.dataset.documents.metadata import Metadata, side_tables
from symolo.dataset.documents.robots import SimulatedRobots
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.documents.scene_record import SCENE
from symolo.dataset.layout import DATA
from symolo.dataset.rates import period_beside_rows_s

_COLOURS: Mapping[ColourFilter, str] = MappingProxyType(
    {
        "none": "red, green and blue at each pixel",
        "bayer": "one of red, green and blue at each pixel, the other two interpolated",
        "monochrome": "none: the sensor measures all colours together",
    }
)


def markdown(metadata: Metadata, example: SceneSpec) -> bytes:
    """Return the description of a dataset; dimensions of robot and arena are those of the run `example`."""
    parts = [_head(metadata), _layout(metadata), columns_part(metadata), _side_tables(metadata, example)]
    parts += [_annotations(metadata), frames_part(metadata), _robot(metadata, example), _further_cameras(example)]
    parts += [_images(metadata, example), _arena(metadata, example), _origins(metadata)]
    parts += [runs_part(metadata), splits_part(metadata), _warnings(metadata), _failed(metadata), _checks()]
    return ("\n\n".join(part for part in parts if part) + "\n").encode()


def _head(metadata: Metadata) -> str:
    made = ", ".join(f"{name} {version}" for name, version in sorted(metadata.made_with.items()))
    about = f"{plain_text(metadata.description)}\n\n" if metadata.description else ""
    contents = Contents.from_metadata(metadata)
    return (
        f"# {plain_text(metadata.name)}\n\n{about}"
        f"{contents.kind} in {LAYOUT}.\n{contents.how_made}\n\n"
        f"Licence: {plain_text(metadata.licence)}. Seed: {metadata.seed}. Made with: {made}."
    )


def _layout(metadata: Metadata) -> str:
    rates = metadata.runs[0].rates
    rows, images = "one row for each pose", "camera images, numbered from 1"
    if rates:
        rows = f"one row every {1000 / rates.control_hz:g} ms ({rates.control_hz} Hz)"
    if rates and rates.camera_hz:
        images = f"camera images every {1000 / rates.camera_hz:g} ms ({rates.camera_hz:g} Hz), numbered from 1"
        if period_beside_rows_s(rates) is not None:
            images += ", also between rows; their times are in side/camera.csv"
    image_text = (
        f"    <route>/test_<n>/images/000001.jpg     {images}\n"
        "    <route>/test_<n>/image_positions.txt   img x y theta: the robot's pose at each shutter [m, rad]\n"
    )
    cameras = "    <route>/test_<n>/cameras/<name>/       the same of each further camera: images, poses, side/\n"
    return (
        "## Layout\n\n"
        f"    <route>/test_<n>/data.csv              {rows}\n"
        f"{image_text if any(run.images for run in metadata.runs) else ''}"
        "    <route>/test_<n>/side/                 more than SyMoLo has: see below\n"
        f"{cameras if metadata.runs[0].cameras else ''}"
        "    metadata.json                          robot, arena, rates, seeds, every value drawn for a setting\n"
        "    bag-info.txt                           size of the data, class of the processors that made them\n"
        "    manifest-sha256.txt                    checksums\n"
        "    tagmanifest-sha256.txt                 checksum of the checksums"
    )


def _origins(metadata: Metadata) -> str:
    rows = [(run.run, run.origin.text) for run in metadata.runs if run.origin]
    return f"## Origin of the trajectories\n\n{markdown_table(('run', 'origin'), rows)}" if rows else ""


def _side_tables(metadata: Metadata, example: SceneSpec) -> str:
    rows = []
    has_images = any(run.images for run in metadata.runs)
    document = RunDocument.model_validate(example)
    for table in (*side_tables(document, has_images=has_images), *metadata.sensor_tables):
        columns = metadata.columns[f"side/{table.file}"]
        rows.append((table.file, table.meaning, ", ".join(f"{c.column.title} [{c.unit}]" for c in columns)))
    if has_images:
        camera = (
            "camera matrix K, distortion D, size, exposure; poses X_RC of the optical frame, X_CB of the body frame"
        )
        rows.append((INTRINSICS, camera, "JSON"))
        drawn = "what was drawn for the run's scene beyond its look: furniture piece by piece, phase of the mains, seed"
        rows.append((SCENE, drawn, "JSON"))
    rows.append(("spec.json", "every number that the run was made from, arena and robot included", "JSON"))
    return f"## side/\n\n{markdown_table(('file', 'meaning', 'columns'), rows)}"


def _annotations(metadata: Metadata) -> str:
    kinds = metadata.runs[0].annotations
    if not kinds:
        return ""
    rows = [(kind, text) for kind, text in ENCODINGS.items() if kind in kinds]
    return (
        f"## annotations/\n\nWhat is known exactly of each image, through the middle of each pixel and at the shutter's"
        f" time; of glass the pane itself. `{DOCUMENT}` holds categories, instances, camera and images, and all that is"
        f" no image.\n\n{markdown_table(('annotation', 'encoding'), rows)}"
    )


def _robot(metadata: Metadata, spec: SceneSpec) -> str:
    robot = spec.robot
    chassis, drive, camera = robot.chassis, robot.drive, robot.camera
    camera_z_m = chassis.base_height_m + camera.height_above_base_m
    axis = f"{camera.pitch_down_deg:g} deg below the horizon, {camera.yaw_left_deg:g} deg to the left"
    axis += f", rolled by {camera.roll_deg:g} deg"
    rows = [
        ("chassis", f"{chassis.length_m:g} x {chassis.width_m:g} m, {chassis.mass_kg:g} kg, centred on the axle"),
        ("track b", f"{drive.track_m:g} m between the wheels' contact points"),
        ("wheel diameter", f"{drive.wheel_diameter_m:g} m"),
        ("encoders", f"{robot.encoder.counts_per_revolution} counts per wheel turn"),
        *_sensors(robot, {column.name for column in metadata.columns[DATA]}),
        ("camera", f"x = {camera.x_m:g}, y = {camera.y_m:g}, z = {camera_z_m:g} m"),
        ("camera axis", axis),
        *_lens(camera),
    ]
    images = "Images are rendered" if any(run.images for run in metadata.runs) else "`symolo rerender` renders images"
    about = f"{plain_text(robot.name)}: {plain_text(robot.description)}."
    whose = f"{images} with this robot; the log may be of another one. " if spec.is_imported else ""
    robots = SimulatedRobots.from_metadata(metadata)
    deviations = "" if spec.is_imported or robots.is_as_set else f" {plain_text(robots.text)}"
    return (
        f"## Robot\n\n{whose}{about}{deviations} Positions are in R; values are"
        f" those of {spec.key} where they are drawn per run.\n\n{markdown_table(('part', 'value'), rows)}"
    )


def _sensors(robot: RobotConfig, columns: Collection[str]) -> list[tuple[str, str]]:
    """Return a row for each sensor whose readings are among these columns of data.csv."""
    line, mounts = robot.line_sensor, robot.tof.mounts
    row = f"x = {line.x_m:g} m, {line.channels} channels, pitch {line.pitch_m:g} m, L0 at the right end"
    return [
        *([("line sensor", row)] if "L0" in columns else []),
        *(
            (f"ToF {name}", f"x = {mount.x_m:g}, y = {mount.y_m:g}, z = {mount.z_m:g} m, turned {mount.yaw_deg:g} deg")
            for name, mount in (("front", mounts.front), ("left", mounts.left), ("right", mounts.right))
            if f"d_{name[0]}" in columns
        ),
    ]


def _lens(camera: Camera) -> list[tuple[str, str]]:
    """Return the rows of the table on the lens of the camera of data.csv."""
    if (lens := camera.fisheye) is not None:
        k = ", ".join(f"{value:g}" for value in (lens.k1, lens.k2, lens.k3, lens.k4))
        return [
            ("field of view", f"{lens.field_of_view_deg:g} deg across"),
            ("lens", f"fisheye, as k1, k2, k3, k4 of OpenCV: {k}"),
        ]
    k = ", ".join(f"{value:g}" for value in coefficients(camera))
    across_deg = math.degrees(2.0 * math.atan(0.5 * camera.sensor_width_mm / camera.focal_length_mm))
    return [
        ("field of view", f"{across_deg:.1f} deg across, without distortion"),
        ("focal length", f"{camera.focal_length_mm:g} mm on a sensor {camera.sensor_width_mm:g} mm wide"),
        ("lens", f"as k1, k2, p1, p2, k3 of OpenCV: {k}"),
    ]


def _further_cameras(spec: SceneSpec) -> str:
    """Return the table of the further cameras; empty if there are none."""
    rows = []
    for camera in cameras_of(spec)[1:]:
        config, render = camera.spec.robot.camera, camera.spec.render
        z_m = spec.robot.chassis.base_height_m + config.height_above_base_m
        axis = f"{config.yaw_left_deg:g} deg to the left, {config.pitch_down_deg:g} deg down"
        axis += f", rolled by {config.roll_deg:g} deg"
        rows.append(
            (
                camera.name,
                "fisheye" if config.fisheye else "pinhole",
                f"x = {config.x_m:g}, y = {config.y_m:g}, z = {z_m:.6g} m",
                axis,
                f"{render.width_px} x {render.height_px} px",
                f"{1000 * camera.period_s:g} ms",
            )
        )
    if not rows:
        return ""
    table = markdown_table(("camera", "lens", "place in R", "axis", "size", "period"), rows)
    return f"## Further cameras\n\nValues are those of {spec.key} where they are drawn per run.\n\n{table}"


def _images(metadata: Metadata, spec: SceneSpec) -> str:
    """Return the table of the look, and of the response of the camera of data.csv; empty without images."""
    if not any(run.images for run in metadata.runs):
        return ""
    camera, look = spec.look.camera, spec.look
    exposure = f"{1000 * camera.exposure_time_s:g} ms" if camera.exposure_time_s else "an instant, without motion blur"
    if (manual := camera.manual_exposure) is not None:
        exposure = f"the same in all images of a run: {exposure}, ISO {manual.iso:g}, f/{manual.f_number:g}"
    else:
        exposure = f"automatic; {exposure}"
    read_out_ms = 1000 * spec.robot.camera.read_out_s
    rows = [
        ("look", f"{plain_text(look.name)}: {plain_text(look.description)}"),
        *([("camera", f"{plain_text(camera.name)}: {plain_text(camera.description)}")] if camera.name else []),
        ("exposure", exposure),
        ("colours", _COLOURS[camera.colour_filter]),
        ("shutter", f"rolling: {read_out_ms:g} ms from the top row to the bottom row" if read_out_ms else "global"),
    ]
    whose = f"Values are those of the camera of data.csv in {spec.key} where they are drawn per run."
    if looks := metadata.scenario.get("looks"):
        names = ", ".join(plain_text(name) for name in sorted(looks))  # as in the file, whose keys are sorted
        whose = (
            f"Each run has one of the looks {names}, which its side/spec.json describes; the values here are those of"
        )
        whose += f" the camera of data.csv in {spec.key}."
    return f"## Images\n\n{whose}\n\n{markdown_table(('part', 'value'), rows)}"


def _arena(metadata: Metadata, spec: SceneSpec) -> str:
    arena, pieces_at = spec.arena, "side/spec.json"
    if any(route.get("arena") for route in metadata.scenario.get("routes", ())):
        whose = f"Routes have arenas of their own, in side/spec.json of their runs; this one is of {spec.key}."
    elif metadata.scenario.get("arena", {}).get("generate"):
        whose = f"Each run has an arena of its own, in its side/spec.json; this one is of {spec.key}."
    else:
        whose, pieces_at = f"Values are those of {spec.key} where they are drawn per run.", "metadata.json"
    rows = [
        (w.name, "wall", f"{_point(w.start)} - {_point(w.end)}", f"height {w.height_m:g} m", w.surface)
        for w in arena.walls
    ]
    rows += [
        (o.name, "obstacle", _place(o), " x ".join(f"{s:g}" for s in o.size) + " m", o.surface) for o in arena.obstacles
    ]
    return (
        f"## Arena\n\n{plain_text(arena.name)}: {plain_text(arena.description.rstrip('.'))}. {whose}"
        f" Line {arena.line.width_m:g} m wide in {plural(len(arena.line.pieces), 'piece')} ({pieces_at})."
        " Positions in W [m].\n\n"
        f"{markdown_table(('name', 'kind', 'position', 'size', 'surface'), rows)}"
    )


def _warnings(metadata: Metadata) -> str:
    rows = [(run.run, warning) for run in metadata.runs for warning in run.warnings]
    return f"## Warnings\n\n{markdown_table(('run', 'warning'), rows)}" if rows else ""


def _failed(metadata: Metadata) -> str:
    if not metadata.failed_runs:
        return ""
    rows = [(run.run, run.stage, run.problem) for run in metadata.failed_runs]
    return f"## Runs that failed and are not here\n\n{markdown_table(('run', 'stage', 'problem'), rows)}"


def _checks() -> str:
    return (
        "## Checking\n\n"
        "    sha256sum -c tagmanifest-sha256.txt manifest-sha256.txt    # every file as it was released\n"
        "    symolo verify .                     # the same; structure, columns, ranges, rates, images; extra files"
    )


def _point(point: tuple[float, float]) -> str:
    return f"({point[0]:g}, {point[1]:g})"


def _place(obstacle: Obstacle) -> str:
    moves = " at t = 0, moves: side/obstacles.csv" if obstacle.motion else ""
    return _point(obstacle.center) + moves
