"""The line bench: the robot's QTR-8A across a straight tape, beside closed forms and the paper's Fig. 5."""

from dataclasses import dataclass

from configs.schema.robot import LineSensor, RobotConfig
from diagnosis.validation.line_sensor.channels import Channels, Converter, Spread, channels, converter
from diagnosis.validation.line_sensor.edge import Crossing, crossings
from diagnosis.validation.line_sensor.rig import Tape
from diagnosis.validation.line_sensor.threshold import Threshold, threshold_bench
from symolo.core.errors import InputError


@dataclass(frozen=True)
class LineBench:
    robot: str
    tape: Tape
    crossings: tuple[Crossing, ...]
    channels: Channels
    converter: Converter
    threshold: Threshold


def check_line(robot: RobotConfig) -> None:
    """Refuse a sensor whose threshold tells the bench's tape from its floor nowhere.

    Raises:
        InputError: The threshold does not lie between the two.
    """
    tape = Tape()
    if not tape.reflectance < robot.line_sensor.threshold < tape.floor_reflectance:
        allowed = f"between the tape's {tape.reflectance} and the floor's {tape.floor_reflectance}"
        raise InputError("robot.line_sensor.threshold", got=robot.line_sensor.threshold, allowed=allowed)


def line_bench(robot: RobotConfig, seed: int) -> LineBench:
    """Everything that the bench measures; `seed` is that of gains, offsets and noise."""
    config: LineSensor = robot.line_sensor
    tape = Tape()
    return LineBench(
        robot=robot.name,
        tape=tape,
        crossings=crossings(config, tape, seed),
        channels=channels(config, seed),
        converter=converter(config, seed),
        threshold=threshold_bench(config, tape),
    )


def summary(bench: LineBench) -> list[str]:
    """A short table for people, a line each."""
    return [
        *map(_crossing_line, bench.crossings),
        _spread_line("gain", bench.channels.gain, bench.channels.robots),
        _spread_line("offset", bench.channels.offset, bench.channels.robots),
        _converter_line(bench.converter),
        *_threshold_lines(bench.threshold),
    ]


def _crossing_line(found: Crossing) -> str:
    width = f"{1e3 * min(found.edge_10_90_m):.3f} ... {1e3 * max(found.edge_10_90_m):.3f} mm"
    closed = f"closed form {1e3 * found.edge_closed_form_m:.3f} mm"
    apart = "" if found.edges_are_apart else " for one edge; this spot sees both"
    return f"height {1e3 * found.height_m:.1f} mm: edge 10-90 % {width}, {closed}{apart}"


def _spread_line(name: str, spread: Spread, robots: int) -> str:
    found = f"mean {spread.mean:.4f}, sd {spread.sd:.4f}"
    return f"{name} of {robots} robots: {found}, configured {spread.configured_sd:.4f} +- {spread.sd_error:.4f}"


def _converter_line(found: Converter) -> str:
    steps = f"steps of {found.step:.7f}, closed form {found.step_closed_form:.7f}"
    error = f"error up to {found.largest_error / found.step_closed_form:.3f} steps"
    return f"converter of {found.bits} bits: {found.levels} levels of {found.levels_expected}, {steps}, {error}"


def _threshold_lines(found: Threshold) -> list[str]:
    lines = []
    for case in found.cases:
        on = " ".join(f"L{channel}" for channel in case.active) or "none"
        verdict = "as in Fig. 5" if case.agrees else "not as in Fig. 5"
        error = "-" if case.line_error is None else f"{case.line_error:+.1f}"
        lines.append(f"robot {1e3 * case.offset_m:+6.2f} mm off the tape: on {on}, error {error}, {verdict}")
    width = f"{_mm(found.narrowest_tape_m)} ... {_mm(found.widest_tape_m)}"
    closed = f"{_mm(found.narrowest_closed_form_m)} ... {_mm(found.widest_closed_form_m)}"
    return [*lines, f"Fig. 5 holds for tapes of {width}, closed form {closed}"]


def _mm(width_m: float | None) -> str:
    return "-" if width_m is None else f"{1e3 * width_m:.2f} mm"
