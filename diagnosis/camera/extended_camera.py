"""The identified camera as robot and look files, which scenarios and `symolo rerender` take."""

from math import log2
from typing import Any, Literal

import yaml

from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.features.white_balance import temperature_of
from diagnosis.camera.views import deviating

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
"""For each number the field of look.camera that it changes, how it does, and the schema's bounds."""
GAINS = ("red_gain_scale", "blue_gain_scale")
NO_TEMPERATURE = "its white balance is a temperature, look.camera.white_balance_K, and none has these gains"
LATE = "no camera of the simulation is late"


def robot_file(diagnosis: CameraDiagnosis) -> str:
    """Return the nominal robot with the fitted geometry of the camera; empty where the nominal one is as good."""
    if not diagnosis.geometry.counts:
        return ""
    case = diagnosis.case
    camera, _ = deviating(case, diagnosis.geometry.fit.x.tolist())
    camera = camera.model_copy(update={"read_out_s": min(max(camera.read_out_s, 0.0), 0.1)})
    whole = case.robot.model_copy(update={"camera": camera})
    return _text(whole.model_dump(mode="json", exclude_none=True), diagnosis, (diagnosis.geometry,))


def look_file(diagnosis: CameraDiagnosis) -> str:
    """Return the nominal look with the named changes of the camera's response; empty where none is named."""
    changed = look_changes(diagnosis)
    if not changed:
        return ""
    look = diagnosis.case.look
    whole = look.model_copy(update={"camera": look.camera.model_copy(update=changed)})
    return _text(whole.model_dump(mode="json", exclude_none=True), diagnosis, diagnosis.photometry)


def look_changes(diagnosis: CameraDiagnosis) -> dict[str, float]:
    """Return the fields of look.camera with their new values, within the bounds of the schema."""
    now, changed = diagnosis.case.look.camera, {}
    for part in diagnosis.photometry:
        for choice in part.chosen.choices:
            if choice.number.name not in FIELDS:
                continue
            field, how, low, high = FIELDS[choice.number.name]
            value, _ = part.value(choice.place, diagnosis.case)
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
    kelvin = white_balance_K(diagnosis)
    return changed if kelvin is None else changed | {"white_balance_K": round(kelvin), "white_balance_adaption": 0.0}


def white_balance_K(diagnosis: CameraDiagnosis) -> float | None:
    """Return the white-balance temperature where it differs; None where it does not or where no temperature fits."""
    if not any(choice.number.name in GAINS for _, choice in diagnosis.named):
        return None
    gains = {
        number.name: part.value(place, diagnosis.case)
        for part in diagnosis.photometry
        for place, number in enumerate(part.model.numbers)
        if number.name in GAINS
    }
    (red, red_sd), (blue, blue_sd) = (gains[name] for name in GAINS)
    of_red, of_green, of_blue = diagnosis.case.response.white_balance
    return temperature_of(red * of_red / of_green, blue * of_blue / of_green, red_sd / red, blue_sd / blue)


def left_out(diagnosis: CameraDiagnosis) -> list[tuple[str, str]]:
    """Return what is named but cannot be written into either file, with the reason."""
    why = {"time_offset": LATE}
    if white_balance_K(diagnosis) is None:
        why |= dict.fromkeys(GAINS, NO_TEMPERATURE)
    names = (choice.number.name for _, choice in diagnosis.named)
    return [(name, why[name]) for name in names if name in why]


def _text(section: dict[str, Any], diagnosis: CameraDiagnosis, parts: tuple[CameraAspect, ...]) -> str:
    lines = [f"# As identified in images of {diagnosis.case.name}; value and standard error:"]
    for part in parts:
        for place, number in enumerate(part.model.numbers):
            named = any(choice.place == place for choice in part.chosen.choices)
            value, sd = part.value(place, diagnosis.case)
            within = "" if named else ", within its tolerance"
            if named or part is diagnosis.geometry:
                lines.append(f"#   {number.name}: {value:.5g} +- {sd:.2g} {number.unit}{within}")
    return "\n".join(lines) + "\n" + yaml.safe_dump(section, sort_keys=False)
