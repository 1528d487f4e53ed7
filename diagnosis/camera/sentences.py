"""The result of a camera identification in sentences."""

from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.extended_camera import LOOK, ROBOT, left_out, look_file, robot_file
from diagnosis.camera.fit import NamedParameter
from diagnosis.report.sentences.quantities import listed

RECORD = {
    "pitch_down": "images of lines that cross the view, near and far",
    "principal_point_down": "a calibration board that fills the image",
    "principal_point_right": "a calibration board that fills the image",
    "height": "a line of known width right below the camera",
    "focal_length_scale": "a calibration board, or a line of known width at two distances",
    "yaw_left": "a long straight line to both sides",
    "roll": "a line across the view",
    "forward": "turns on the spot, and lines across the view",
    "left": "a long straight line, driven both ways",
    "k1": "lines in the image's corners",
    "k2": "lines in the image's corners",
    "time_offset": "drives at several speeds and turns",
    "read_out": "fast turns",
    "exposure_scale": "the same exposure under another light",
    "red_gain_scale": "a grey card",
    "blue_gain_scale": "a grey card",
    "vignetting": "an evenly lit wall",
    "veiling_glare": "a dark patch beside a lamp",
    "contrast_scale": "a chart of grey steps",
    "saturation_scale": "a chart of colours",
    "lens_blur": "images of a robot that stands still",
    "exposure_time": "edges across the view in fast turns",
    "sharpening": "a slanted edge of a chart",
    "shot_noise_scale": "the same place at several exposures",
    "read_noise_scale": "images with the lens covered",
}
"""Recordings in which a parameter shows more clearly than those that could replace it."""


def headline(diagnosis: CameraDiagnosis) -> str:
    """Return the result in one sentence."""
    names = [named.parameter.name for _, named in diagnosis.named]
    if not names:
        return "The images agree with the nominal camera within its tolerances."
    return f"The real camera differs from the nominal camera in {listed(names)}."


def size(aspect: CameraAspect, named: NamedParameter, diagnosis: CameraDiagnosis) -> str:
    """Return value, standard error and unit of a named parameter."""
    value, sd = aspect.value(named.place, diagnosis.case)
    unit = "" if named.parameter.unit == "1" else f" {named.parameter.unit}"
    return f"{value:.4g} +- {sd:.2g}{unit}"


def ambiguity(named: NamedParameter) -> str:
    """Return which other parameters explain the images as well, and what would decide; empty where there are none."""
    rivals = named.ambiguous_with
    if not rivals:
        return ""
    advice = "; ".join(f"for {name}, {RECORD[name]}" for name in (named.parameter.name, *rivals))
    return f"These images do not distinguish it from {listed(rivals)}. To distinguish them, record: {advice}."


def gain_sentence(aspect: CameraAspect) -> str:
    """Return the errors of an aspect on held-out images, and its gain; empty where no image is held out."""
    gain = aspect.gain
    if gain is None:
        return ""
    unit = aspect.model.unit
    errors = (
        f"{aspect.name}: the error on held-out images is {gain.before:.3g} {unit} with the nominal camera "
        f"and {gain.after:.3g} {unit} with the fitted camera"
    )
    if gain.low <= 0:
        return f"{errors}; the difference is not significant."
    interval = f"95 % interval {100 * gain.low:.1f} % to {100 * gain.high:.1f} %"
    within = "" if aspect.selection.named else " All its parameters are within their tolerances."
    return f"{errors}, a gain of {100 * gain.value:.1f} % ({interval}).{within}"


def summary(diagnosis: CameraDiagnosis) -> list[str]:
    """Return the lines that the terminal shows."""
    lines = [headline(diagnosis), ""]
    for aspect, named in diagnosis.named:
        parameter, confidence = named.parameter, min(100 * named.confidence, 99.9)
        lines += [
            parameter.name,
            f"  value            {size(aspect, named, diagnosis)}",
            f"  meaning          {parameter.meaning}",
            f"  possible causes  {parameter.causes}",
            f"  confidence       {confidence:.1f} %; without this parameter the cost rises by {named.rise:.0f}",
        ]
        if text := ambiguity(named):
            lines.append(f"  ambiguity        {text}")
        lines.append("")
    lines += [text for aspect in diagnosis.aspects if (text := gain_sentence(aspect))]
    for aspect in diagnosis.aspects:
        if aspect.remaining_structure:
            covariate = aspect.remaining_structure.covariate
            lines.append(f"Unexplained: the residuals of {aspect.name} depend on the {covariate}.")
    lines += [f"Not measured: {text}." for text in diagnosis.left_out]
    lines += [f"Not in the files: {name}, because {reason}." for name, reason in left_out(diagnosis)]
    if lines_to_run := commands(diagnosis):
        lines += ["", "To simulate with the identified camera:", *lines_to_run]
    return lines


def commands(diagnosis: CameraDiagnosis) -> list[str]:
    """Return the commands that simulate with the identified camera; empty where nothing differs."""
    robot, look = bool(robot_file(diagnosis)), bool(look_file(diagnosis))
    if not (robot or look):
        return []
    settings = [f"--set robot={ROBOT}"] * robot + [f"--set look={LOOK}"] * look
    options = [f"--robot {ROBOT}"] * robot + [f"--look {LOOK if look else 'NAME'}"]
    return [
        f"symolo release SCENARIO {' '.join(settings)} --out DIR",
        f"symolo rerender RUN {' '.join(options)} --out DIR",
    ]
