"""Names of files and folders in a dataset and in a run."""

DESCRIPTION = "README.md"
DATA, POSITIONS, SIDE, IMAGES, ANNOTATIONS = "data.csv", "image_positions.txt", "side", "images", "annotations"
SPEC = "spec.json"
"""Run specification, in `side/` and in the folder of the first stage."""
JOB, UNPACKED_JOB = "job.json.gz", "job.json"
"""Input of the renderer, in the folder of a stage that renders; earlier versions wrote it without packing it."""
STAGES, DONE = ".stages", "done.json"
"""Hidden folder of an output folder with the results of each stage, and the last file that a finished stage writes."""
CAMERAS = "cameras"
"""Folder of a run with a folder for each further camera, which has images/, side/ and annotations/ as the run has."""
MAX_NAME = 64
NAME_PATTERN = rf"^[A-Za-z0-9][A-Za-z0-9_-]{{0,{MAX_NAME - 1}}}$"
"""Pattern of names that become names of files and folders: of a dataset, a route, a part of an arena."""


def frame_name(number: int) -> str:
    """Return the file name of the image with this number."""
    return f"{number:06d}.jpg"


def camera_folder(name: str) -> str:
    """Return the path of the folder of a further camera within that of a run."""
    return f"{CAMERAS}/{name}"


def camera_and_file(path: str) -> tuple[str, str]:
    """Return the name of the further camera to which a path within a run belongs, and the path within its folder.

    A file of the run itself has no camera: the name is empty, and the path is the whole path.
    """
    first, _, rest = path.partition("/")
    name, _, inner = rest.partition("/")
    return (name, inner) if first == CAMERAS and inner else ("", path)
