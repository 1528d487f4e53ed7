"""The camera that was found, as robot and look files that scenarios and `symolo rerender` take."""

from math import log2
from typing import Any, Literal

import yaml

from diagnosis.pictures.diagnose import Part, PictureDiagnosis
from diagnosis.pictures.views import deviating

ROBOT, LOOK = "robot.yaml", "look.yaml"
FIELDS: dict[str, tuple[str, Literal["steps", "more", "times", "whole"], float, float]] = {
    "exposure_scale": ("compensation_ev", "steps", -6.0, 6.0),
    "vignetting": ("vignetting", "more", 0.0, 1.0),
    "veiling_glare": ("veiling_glare", "more", 0.0, 0.3),
    "contrast_scale": ("contrast", "times", 0.5, 2.0),
    "saturation_scale": ("saturation", "times", 0.0, 2.0),
    "lens_blur": ("lens_blur_px", "whole", 0.0, 5.0),
    "exposure_time": ("exposure_time_s", "whole", 0.0, 0.1),
    "sharpening": ("sharpening", "more", 0.0, 3.0),
    "shot_noise_scale": ("shot_noise", "times", 0.0, 0.5),
    "read_noise_scale": ("read_noise", "times", 0.0, 0.5),
}
"""Of look.camera: which field a number changes, how, and the schema's bounds."""
NOT_IN_A_FILE = {
    "time_offset": "no camera of the simulation is late",
    "red_gain_scale": "its white balance is a temperature, look.camera.white_balance_K",
    "blue_gain_scale": "its white balance is a temperature, look.camera.white_balance_K",
}


def robot_file(diagnosis: PictureDiagnosis) -> str:
    """The nominal robot with the camera's geometry as fitted; empty where the nominal one does as well."""
    if not diagnosis.geometry.counts:
        return ""
    case = diagnosis.case
    camera, _ = deviating(case, diagnosis.geometry.fit.x.tolist())
    camera = camera.model_copy(update={"read_out_s": min(max(camera.read_out_s, 0.0), 0.1)})
    whole = case.robot.model_copy(update={"camera": camera})
    return _text(whole.model_dump(mode="json", exclude_none=True), diagnosis, (diagnosis.geometry,))


def look_file(diagnosis: PictureDiagnosis) -> str:
    """The nominal look with what was named of the camera's response; empty where nothing was."""
    changed = look_changes(diagnosis)
    if not changed:
        return ""
    look = diagnosis.case.look
    whole = look.model_copy(update={"camera": look.camera.model_copy(update=changed)})
    return _text(whole.model_dump(mode="json", exclude_none=True), diagnosis, diagnosis.photometry)


def look_changes(diagnosis: PictureDiagnosis) -> dict[str, float]:
    """Fields of look.camera with their new values, within what the schema allows."""
    now, changed = diagnosis.case.look.camera, {}
    for part in diagnosis.photometry:
        for choice in part.chosen.choices:
            if choice.number.name not in FIELDS:
                continue
            field, how, low, high = FIELDS[choice.number.name]
            value, _ = part.found(choice.place, diagnosis.case)
            match how:
                case "steps":
                    value = getattr(now, field) + log2(value)
                case "more":
                    value += getattr(now, field)
                case "times":
                    value *= getattr(now, field)
                case "whole":
                    pass
            changed[field] = round(min(max(value, low), high), 6)
    return changed


def left_out(diagnosis: PictureDiagnosis) -> list[tuple[str, str]]:
    """What was named and stands in neither file, and why."""
    names = (choice.number.name for _, choice in diagnosis.named)
    return [(name, NOT_IN_A_FILE[name]) for name in names if name in NOT_IN_A_FILE]


def _text(section: dict[str, Any], diagnosis: PictureDiagnosis, parts: tuple[Part, ...]) -> str:
    lines = [f"# As found in pictures of {diagnosis.case.name}; value and standard error:"]
    for part in parts:
        for place, number in enumerate(part.model.numbers):
            named = any(choice.place == place for choice in part.chosen.choices)
            value, sd = part.found(place, diagnosis.case)
            within = "" if named else ", within its tolerance"
            if named or part is diagnosis.geometry:
                lines.append(f"#   {number.name}: {value:.5g} +- {sd:.2g} {number.unit}{within}")
    return "\n".join(lines) + "\n" + yaml.safe_dump(section, sort_keys=False)
