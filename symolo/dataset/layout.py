"""Where things lie in the folder of a dataset and of a run."""

DESCRIPTION = "README.md"
DATA, POSITIONS, SIDE, IMAGES, ANNOTATIONS = "data.csv", "image_positions.txt", "side", "images", "annotations"
SPEC = "spec.json"
"""Below `side/`, and beside what the first stage made."""
JOB, LOOK = "job.json", "look.json"
"""Beside the images of `rerender`: what they were rendered from, and what was drawn for them."""
STAGES, DONE = ".stages", "done.json"
"""Hidden folder of an output folder with the results of each stage, and the last file that a finished stage writes."""
NAME_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"
"""Pattern of names that become names of files and folders: of a dataset, a route, a part of an arena."""


def frame_name(number: int) -> str:
    """Return the file name of the image with this number."""
    return f"{number:06d}.jpg"
