"""How many times faster than real time the firmware runs on the simulated board in lock-step, and its time to answer.

A lap is driven once by the Python controller; its sensor readings are then sent to the board, tick by tick, so that no
engine is timed. Two such drives must be the same to the cycle.

    python benchmarks/hil/lockstep_speed.py [--scenario symolo] [--route CW] [--framing framed]
"""

import argparse
import resource
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from hil.board.process import CLOCK_HZ
from hil.build import build_firmware
from hil.frames import SensorFrame
from hil.framings import FRAMINGS
from hil.links.lockstep import LockstepLink
from hil.loop import Actuation, BoardLoop, LoopSettings
from pipeline.stages.simulate import simulate
from symolo.core.tables.time_series import Recording


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="symolo")
    parser.add_argument("--route", default="CW")
    parser.add_argument("--framing", choices=FRAMINGS, default="framed")
    arguments = parser.parse_args()
    spec = draw_run(load_scenario(arguments.scenario), arguments.route, 1)
    recording = simulate(spec).recording
    frames = sensor_frames(recording)
    framing = FRAMINGS[arguments.framing]
    tick_s = 1.0 / spec.rates.control_hz
    with tempfile.TemporaryDirectory() as folder:
        elf = build_firmware(spec.robot, arguments.framing, framing.baud, Path(folder)).elf
        drives = []
        for _ in range(2):
            link = LockstepLink(elf, framing.baud)
            loop = BoardLoop.for_robot(link, framing, spec.robot, LoopSettings(tick_s, delay_ticks=0))
            loop.start()
            drives.append(timed(loop, link, frames))
            link.close()
    states = [int(state) for state in recording.trajectory.state]
    for actuations, arrivals, wall_s in drives:
        answers_ms = 1000.0 * np.array([at[-1] for at in arrivals]) / CLOCK_HZ
        same = sum(actuation.state == state for actuation, state in zip(actuations, states, strict=True))
        print(f"{len(frames)} ticks in {wall_s:.2f} s: {len(frames) * tick_s / wall_s:.0f} times real time")
        print(f"answer in [ms]: median {np.median(answers_ms):.2f}, worst {answers_ms.max():.2f}")
        print(f"state as in Python at {same} of {len(states)} ticks")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"two drives the same to the cycle: {drives[0][:2] == drives[1][:2]}; children took {used.ru_utime:.2f} s")


def sensor_frames(recording: Recording) -> list[SensorFrame]:
    """Return the sensor readings of a run at each tick."""
    by_name = {series.name: series.values for series in recording.series}
    counts = np.concatenate([[[0, 0]], by_name["encoder_counts"]]).astype(int)
    increments = [(int(now[0] - before[0]), int(now[1] - before[1])) for before, now in pairwise(counts)]
    return [
        SensorFrame(increment, tuple(map(float, line)), *map(float, ranges))
        for increment, line, ranges in zip(increments, by_name["line"], by_name["tof_m"], strict=True)
    ]


def timed(
    loop: BoardLoop, link: LockstepLink, frames: list[SensorFrame]
) -> tuple[list[Actuation], list[tuple[int, ...]], float]:
    actuations, arrivals = [], []
    began = time.perf_counter()
    for frame in frames:
        actuations.append(loop.step(frame))
        arrivals.append(link.arrivals)
    return actuations, arrivals, time.perf_counter() - began


if __name__ == "__main__":
    main()
