"""The result of a camera identification in sentences."""

from diagnosis.camera.diagnose import CameraAspect, CameraDiagnosis
from diagnosis.camera.extended_camera import LOOK, ROBOT, left_out, look_file, robot_file
from diagnosis.camera.fit import NamedCameraNumber

SHOWS_IN = {
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
    "line_width": "a ruler",
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


def headline(diagnosis: CameraDiagnosis) -> str:
    names = [choice.number.name for _, choice in diagnosis.named]
    if not names:
        return "These images do not differ from the simulated camera's by more than its tolerances."
    return f"The real camera differs from the nominal one by {' and '.join(names)}."


def size(part: CameraAspect, choice: NamedCameraNumber, diagnosis: CameraDiagnosis) -> str:
    value, sd = part.value(choice.place, diagnosis.case)
    unit = "" if choice.number.unit == "1" else f" {choice.number.unit}"
    return f"{value:.4g} +- {sd:.2g}{unit}"


def ambiguity(choice: NamedCameraNumber) -> str:
    """Return which other names explain the images as well; empty where none does."""
    if not choice.ambiguous_with:
        return ""
    shows = "; ".join(f"{name}: {SHOWS_IN[name]}" for name in (choice.number.name, *choice.ambiguous_with))
    return f"cannot be told from {', '.join(choice.ambiguous_with)}; to tell them apart, take more of ({shows})"


def gained(part: CameraAspect) -> str:
    """Return the gain of an aspect in a sentence; empty where no image is held out."""
    gain = part.gain
    if gain is None:
        return ""
    told = f"{part.name}: {gain.before:.3g} {part.unit} with the nominal camera, {gain.after:.3g} as fitted"
    if gain.low > 0:
        told += f": a gain of {100 * gain.value:.1f} % ({100 * gain.low:.1f} % to {100 * gain.high:.1f} %)"
        if not part.chosen.choices:
            told += ", by numbers each within its tolerance"
    return told


def summary(diagnosis: CameraDiagnosis) -> list[str]:
    """Return the lines that the terminal shows."""
    heldout = int(diagnosis.case.heldout.sum())
    lines = [headline(diagnosis), ""]
    for part, choice in diagnosis.named:
        number = choice.number
        lines += [
            number.name,
            f"  value      {size(part, choice, diagnosis)}",
            f"  means      {number.means}",
            f"  comes of   {number.comes_of}",
            f"  sure to    {min(100 * choice.confidence, 99.9):.1f} %; without it the cost rises by {choice.rise:.0f}",
        ]
        if told := ambiguity(choice):
            lines.append(f"  open       {told}")
        lines.append("")
    lines.append(f"On {heldout} images that nothing was fitted to, the error is")
    lines += [f"  {told}" for part in diagnosis.parts if (told := gained(part))]
    for part in diagnosis.parts:
        if part.remaining_structure:
            lines.append(f"Unexplained: what is left of {part.name} depends on {part.remaining_structure.covariate}.")
    lines += [f"Not measured: {what}." for what in diagnosis.left_out]
    lines += [f"Not in the files: {name}, for {why}." for name, why in left_out(diagnosis)]
    if told := use(diagnosis):
        lines += ["", *told]
    return lines


def use(diagnosis: CameraDiagnosis) -> list[str]:
    """Return how to simulate with the identified camera; empty where nothing differs."""
    robot, look = bool(robot_file(diagnosis)), bool(look_file(diagnosis))
    if not (robot or look):
        return []
    given = [f"--set robot={ROBOT}"] * robot + [f"--set look={LOOK}"] * look
    again = [f"--robot {ROBOT}"] * robot + [f"--look {LOOK if look else 'NAME'}"]
    return [f"symolo release SCENARIO {' '.join(given)} --out DIR", f"symolo rerender RUN {' '.join(again)} --out DIR"]
