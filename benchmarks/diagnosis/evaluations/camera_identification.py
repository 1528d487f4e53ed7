"""Names that the camera identification gives to deviations that are hidden in rendered images.

python benchmarks/diagnosis/evaluations/camera_identification.py RUN FOLDER [--workers 2]

RUN is a run of a dataset with its images, such as smoke/CW/test_1. Renders it again with other stains and other
noise, once as it is and then with one thing changed each time, into FOLDER, and diagnoses each against RUN.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from diagnosis.camera.case import PoseErrors
from diagnosis.camera.diagnose import diagnose_camera
from pipeline.diagnosing.camera_case import read_camera_case

HIDDEN = {
    "none": {},
    "pitch +1.5 deg": {"robot.camera.pitch_down_deg": 1.5},
    "height +3 mm": {"robot.camera.height_above_base_m": 0.003},
    "exposure x 1.3": {"look.camera.compensation_ev": 0.3785},
    "blur 1 px": {"look.camera.lens_blur_px": 1.0},
    "pitch and exposure": {"robot.camera.pitch_down_deg": -1.5, "look.camera.compensation_ev": -0.5},
    "focal length x 0.97": {"robot.camera.focal_length_mm": -0.9},
}
TRUE = {
    "none": set(),
    "pitch +1.5 deg": {"pitch_down"},
    "height +3 mm": {"height"},
    "exposure x 1.3": {"exposure_scale"},
    "blur 1 px": {"lens_blur"},
    "pitch and exposure": {"pitch_down", "exposure_scale"},
    "focal length x 0.97": {"focal_length_scale"},
}
OTHER_SEED = 7
"""Seed of stains and noise."""


def rendered(run: Path, name: str, folder: Path, quality: str, workers: int) -> Path:
    """Return the folder of the run's images, rendered with the deviations of a case."""
    out = folder / name.replace(" ", "_")
    spec = json.loads((run / "side" / "spec.json").read_text())
    for path, added in HIDDEN[name].items():
        section, part, field = path.split(".")
        spec[section][part][field] = spec[section][part].get(field, 0.0) + added
    folder.mkdir(parents=True, exist_ok=True)
    files = {}
    for section in ("robot", "look"):
        files[section] = folder / f"{out.name}_{section}.yaml"
        files[section].write_text(json.dumps(spec[section]))
    options = ["rerender", str(run), "--look", str(files["look"]), "--robot", str(files["robot"]), "--out", str(out)]
    options += ["--seed", str(OTHER_SEED), "--workers", str(workers)]
    options += ["--set", f"render.quality={quality}"]
    command = "import sys; from pipeline.cli import main; sys.exit(main(sys.argv[1:]))"
    subprocess.run([sys.executable, "-c", command, *options], check=True)
    return out / run.parent.name / run.name


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--quality", default="standard", help="of the renderings; draft for a quick look")
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    for name, expected in TRUE.items():
        out = rendered(arguments.run, name, arguments.folder, arguments.quality, arguments.workers)
        answer = diagnose_camera(read_camera_case(out, arguments.run, PoseErrors())).answer()
        names = {effect["name"] for effect in answer["effects"]}
        effects = ", ".join(
            f"{e['name']} {e['value']:.4g} +- {e['std']:.2g} {e['ambiguous_with']}" for e in answer["effects"]
        )
        verdict = "right" if names == expected else "WRONG"
        held = ", ".join(f"{k} {v['before']:.3g} to {v['after']:.3g}" for k, v in answer["heldout"].items())
        print(
            f"{name:20} {verdict:6} {effects or 'nothing'} | held out: {held} | {answer.get('unexplained_where', '')}",
            flush=True,
        )


if __name__ == "__main__":
    main()
