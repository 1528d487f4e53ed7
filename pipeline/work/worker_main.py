"""The worker process: `python -m pipeline.work.worker_main` reads a unit a line, does it and says how it goes.

Its input stays open as long as the supervisor lives and wants it; when it closes, the worker ends itself and its
children.
"""

import os
import queue
import shutil
import signal
import sys
import threading
import time
import traceback
from typing import TextIO

from pipeline.work.units import UNITS, Alive, AnyUnit, EngineFailed, Failed, Finished, Message, Progress, Tell
from pipeline.work.worker_process import SCRATCH
from symolo.core.errors import EnvironmentLacking, InputError, RunFailed
from symolo.core.os_errors import lacking

SECONDS_BETWEEN_BEATS = 5.0


class Channel:
    """What the supervisor hears, one message a line; several threads speak."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._speaking = threading.Lock()

    def say(self, message: Message) -> None:
        with self._speaking:
            self._stream.write(message.model_dump_json() + "\n")
            self._stream.flush()

    def keep_saying_so(self) -> None:
        while True:
            time.sleep(SECONDS_BETWEEN_BEATS)
            self.say(Alive())


def main() -> None:
    # Engines print to file descriptor 1 whatever Python's sys.stdout is, so that the channel gets one of its own.
    channel = Channel(os.fdopen(os.dup(1), "w", encoding="utf-8"))
    os.dup2(2, 1)
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(lines,), daemon=True).start()
    threading.Thread(target=channel.keep_saying_so, daemon=True).start()
    while True:
        unit = UNITS.validate_json(lines.get())
        channel.say(do(unit, lambda share, at=None: channel.say(Progress(share=share, at=at))))


def do(unit: AnyUnit, progress: Tell) -> Finished | Failed:
    """Do a unit, and say what came of it in the words of the protocol."""
    try:
        unit.run(progress)
    except InputError as error:
        return Failed(error="input", text=str(error))
    except EnvironmentLacking as error:
        return Failed(error="environment", text=str(error))
    except RunFailed as error:
        return Failed(error="run", text=str(error))
    except EngineFailed as error:
        return Failed(error="engine", text=str(error))
    except Exception as error:  # noqa: BLE001 - reported with its traceback by the supervisor, which decides
        if told := lacking(error):
            return Failed(error="environment", text=told)
        return Failed(error="bug", text=traceback.format_exc())
    return Finished()


def _listen(lines: "queue.SimpleQueue[str]") -> None:
    """Passes units on, and ends all when the supervisor is gone, even killed: its end of the pipe closes with it."""
    for line in sys.stdin:
        lines.put(line)
    if scratch := os.environ.get(SCRATCH):
        shutil.rmtree(scratch, ignore_errors=True)
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    main()
