"""A live view, on the terminal, of a run that a board drives."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from configs.schema.scenario import RunSpec
from physics.control.base import Observation
from physics.run.controller_runner import Decision
from symolo.dataset.codes import BOARD_COLUMNS
from symolo.dataset.documents.metadata import STATES

BETWEEN_S = 0.1
"""Real time [s] between two updates; a simulated board is many times faster."""
_BLOCKS = " ▁▂▃▄▅▆▇█"
_RANGE_CELLS = 20


class LiveView:
    """The live view of a run: state, speeds, ranges, line sensor, and the line to the board."""

    def __init__(self, spec: RunSpec, live: Live) -> None:
        self._spec, self._live = spec, live
        self._began_s = self._shown_s = time.monotonic()
        self._counts = dict.fromkeys(BOARD_COLUMNS, 0)

    def show(self, t_s: float, seen: Observation, decision: Decision) -> None:
        """Take one control tick; the view is updated ten times a second."""
        for name, count in zip(BOARD_COLUMNS, decision.board, strict=bool(decision.board)):
            self._counts[name] += count
        now_s = time.monotonic()
        if now_s - self._shown_s >= BETWEEN_S:
            self._shown_s = now_s
            self._live.update(self._table(t_s, seen, decision, now_s - self._began_s), refresh=True)

    def _table(self, t_s: float, seen: Observation, decision: Decision, passed_s: float) -> Table:
        command, right, left = decision.command, *decision.wheels_rad_s
        table = Table.grid(padding=(0, 2))
        table.add_row("run", f"{self._spec.key}   {t_s:.1f} s of at most {self._spec.stop.time_limit_s:g} s")
        table.add_row("speed", f"{t_s / max(passed_s, 1e-3):.1f} times real time")
        table.add_row("state", f"{int(command.state)}  {STATES[command.state]}")
        table.add_row("drive", f"v {command.v_m_s:+.3f} m/s   w {command.w_rad_s:+.2f} rad/s")
        table.add_row("wheels", f"left {left:+.2f}   right {right:+.2f} rad/s")
        tof = self._spec.robot.tof
        for name, range_m in (("left", seen.left_m), ("front", seen.front_m), ("right", seen.right_m)):
            bar = "█" * round(_RANGE_CELLS * min(1.0, range_m / tof.max_range_m))
            table.add_row(f"{name} range", f"{range_m:.3f} m {bar}" if range_m < tof.no_target_m else "no target")
        table.add_row("line, left to right", Text("".join(_block(value) for value in reversed(seen.line))))
        ticks = round(t_s * self._spec.rates.control_hz) + 1
        counts = [f"{self._counts['answered']} of {ticks} answered"]
        counts += [f"{count} {name}" for name, count in self._counts.items() if count and name != "answered"]
        table.add_row("board", ", ".join(counts).replace("_", " "))
        return table


@contextmanager
def live_view(spec: RunSpec) -> Iterator[LiveView]:
    """Show a live view until the run ends."""
    with Live(console=Console(stderr=True), auto_refresh=False, transient=True) as live:
        yield LiveView(spec, live)


def _block(reflectance: float) -> str:
    """Return a block that is higher where it is darker, so that a dark line stands out."""
    return _BLOCKS[round((len(_BLOCKS) - 1) * (1.0 - min(max(reflectance, 0.0), 1.0)))]
