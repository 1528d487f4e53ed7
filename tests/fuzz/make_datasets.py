"""Make the valid dataset and bag of the corpus again: `python tests/fuzz/make_datasets.py`; after a change of form."""

import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
CORPUS = ROOT / "tests" / "fuzz" / "corpus"
KINDS = "depth,instance,semantic,normals,flow,free_floor,boxes_2d,boxes_3d,key_points"
SETTINGS = ("stop.time_limit_s=0.4", "render.width_px=24", "render.height_px=16", f"render.annotations=[{KINDS}]")
STAGES_LEFT_OUT = ("render", "annotate")
"""Half a megabyte of render jobs each."""


def make() -> None:
    """Release nine rows and three images in a bare room, and wrap them as a bag, of which the payload is left out."""
    sys.path.insert(0, str(ROOT))
    from pipeline.cli import main  # noqa: PLC0415 - after the path
    from symolo.core.progress import LineReport  # noqa: PLC0415
    from symolo.publishing.bagging import make_bag  # noqa: PLC0415

    dataset, bag = CORPUS / "dataset" / "valid", CORPUS / "bag" / "valid"
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "release"
        settings = [f"--set={setting}" for setting in SETTINGS]
        scenario = ROOT / "tests" / "faults" / "bare.yaml"
        if main(["release", str(scenario), "--out", str(made), "--workers", "1", *settings]):
            raise SystemExit(1)
        for stage in STAGES_LEFT_OUT:
            shutil.rmtree(made / ".stages" / stage)
        for lock in made.rglob(".lock"):
            lock.unlink()
        make_bag(made, Path(folder) / "bag", LineReport())
        shutil.rmtree(Path(folder) / "bag" / "data")
        for old, new in ((dataset, made), (bag, Path(folder) / "bag")):
            shutil.rmtree(old, ignore_errors=True)
            shutil.copytree(new, old)


if __name__ == "__main__":
    make()
