"""The identified camera as robot and look files, which scenarios and `symolo rerender` take."""

from math import log2
from typing import Literal

import yaml

from configs.schema.base import Section
from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.features.white_balance import temperature_of
from diagnosis.camera.views import deviating

ROBOT, LOOK = "robot.yaml", "look.yaml"
FIELDS: dict[str, tuple[str, Literal["exposure steps", "added", "factor", "replaced"], float, float]] = {
    "exposure_scale": ("compensation_ev", "exposure steps", -6.0, 6.0),
    "vignetting": ("vignetting", "added", 0.0, 1.0),
    "veiling_glare": ("veiling_glare", "added", 0.0, 0.3),
    "contrast_scale": ("contrast", "factor", 0.5, 2.0),
    "saturation_scale": ("saturation", "factor", 0.0, 2.0),
    "lens_blur": ("lens_blur_px", "replaced", 0.0, 5.0),
    "exposure_time": ("exposure_time_s", "replaced", 0.0, 0.1),
    "sharpening": ("sharpening", "added", 0.0, 3.0),
    "shot_noise_scale": ("shot_noise", "factor", 0.0, 0.5),
    "read_noise_scale": ("read_noise", "factor", 0.0, 0.5),
}
"""For each parameter the field of look.camera that it changes, the kind of change, and the bounds of the schema.

The fitted value is a number of exposure steps, by which the field rises; it is added to the field; it multiplies the
field; or it replaces the field.
"""
GAINS = ("red_gain_scale", "blue_gain_scale")
NO_TEMPERATURE = "no colour temperature (look.camera.white_balance_K) has these gains of red and blue"
LATE = "the simulated camera has no time offset"


def robot_file(diagnosis: CameraDiagnosis) -> str:
    """Return the nominal robot with the fitted geometry of the camera; empty where the nominal one is as good."""
    if not diagnosis.geometry.is_better:
        return ""
    case = diagnosis.case
    camera, _ = deviating(case, diagnosis.geometry.fit.x.tolist())
    camera = camera.model_copy(update={"read_out_s": min(max(camera.read_out_s, 0.0), 0.1)})
    return _text(case.robot.model_copy(update={"camera": camera}), diagnosis, (diagnosis.geometry,))


def look_file(diagnosis: CameraDiagnosis) -> str:
    """Return the nominal look with the named changes of the camera's response; empty where none is named."""
    changes = look_changes(diagnosis)
    if not changes:
        return ""
    look = diagnosis.case.look
    changed = look.model_copy(update={"camera": look.camera.model_copy(update=changes)})
    return _text(changed, diagnosis, diagnosis.photometry)


def look_changes(diagnosis: CameraDiagnosis) -> dict[str, float]:
    """Return the fields of look.camera with their new values, within the bounds of the schema."""
    nominal, changes = diagnosis.case.look.camera, {}
    for aspect, named in diagnosis.named:
        if named.parameter.name not in FIELDS:
            continue
        field, change, low, high = FIELDS[named.parameter.name]
        value, _ = aspect.value(named.place, diagnosis.case)
        match change:
            case "exposure steps":
                value = getattr(nominal, field) + log2(value)
            case "added":
                value += getattr(nominal, field)
            case "factor":
                value *= getattr(nominal, field)
            case "replaced":
                pass
        changes[field] = round(min(max(value, low), high), 6)
    kelvin = white_balance_K(diagnosis)
    return changes if kelvin is None else changes | {"white_balance_K": round(kelvin), "white_balance_adaption": 0.0}


def white_balance_K(diagnosis: CameraDiagnosis) -> float | None:
    """Return the white-balance temperature where it differs; None where it does not or where no temperature fits."""
    if not any(named.parameter.name in GAINS for _, named in diagnosis.named):
        return None
    gains = {
        parameter.name: aspect.value(place, diagnosis.case)
        for aspect in diagnosis.photometry
        for place, parameter in enumerate(aspect.model.parameters)
        if parameter.name in GAINS
    }
    (red, red_sd), (blue, blue_sd) = (gains[name] for name in GAINS)
    nominal_red, nominal_green, nominal_blue = diagnosis.case.response.white_balance
    return temperature_of(
        red * nominal_red / nominal_green, blue * nominal_blue / nominal_green, red_sd / red, blue_sd / blue
    )


def left_out(diagnosis: CameraDiagnosis) -> list[tuple[str, str]]:
    """Return the named parameters that no file can contain, with the reason."""
    reasons = {"time_offset": LATE}
    if white_balance_K(diagnosis) is None:
        reasons |= dict.fromkeys(GAINS, NO_TEMPERATURE)
    names = (named.parameter.name for _, named in diagnosis.named)
    return [(name, reasons[name]) for name in names if name in reasons]


def _text(section: Section, diagnosis: CameraDiagnosis, aspects: tuple[CameraAspect, ...]) -> str:
    """Return the file of a robot or a look, with the fitted values of some aspects in comments."""
    lines = [f"# Identified from images of {diagnosis.case.name}; value and standard error:"]
    for aspect in aspects:
        places = {named.place for named in aspect.selection.named}
        for place, parameter in enumerate(aspect.model.parameters):
            if place in places or aspect is diagnosis.geometry:
                value, sd = aspect.value(place, diagnosis.case)
                within = "" if place in places else ", within its tolerance"
                lines.append(f"#   {parameter.name}: {value:.5g} +- {sd:.2g} {parameter.unit}{within}")
    tree = section.model_dump(mode="json", exclude_none=True)
    return "\n".join(lines) + "\n" + yaml.safe_dump(tree, sort_keys=False)
