"""Where things lie in the folder of a run."""

DATA, POSITIONS, SIDE, IMAGES = "data.csv", "image_positions.txt", "side", "images"
SPEC = "spec.json"
"""Below `side/`, and beside what the first stage made."""
JOB, LOOK = "job.json", "look.json"
"""Beside the pictures of `rerender`: what they were rendered from, and what was drawn for them."""
