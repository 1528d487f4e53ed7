"""Where things lie in the folder of a run."""

DATA, POSITIONS, SIDE, IMAGES = "data.csv", "image_positions.txt", "side", "images"
SPEC = "spec.json"
"""Below `side/`, and beside what the first stage made."""
