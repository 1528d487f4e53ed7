"""The worker process: `python -m pipeline.worker_main` reads one unit from its input, does it and says how it goes.

Its input stays open as long as the supervisor lives; when it closes, the worker ends itself and its children.
"""

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from typing import TextIO

from configs.errors import EnvironmentLacking, InputError, RunFailed
from configs.refusals import lacking
from pipeline.units import UNITS, AnyUnit, Failed, Finished, Message, Progress


def main() -> None:
    # Engines print to file descriptor 1 whatever Python's sys.stdout is, so that the channel gets one of its own.
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    unit = UNITS.validate_json(sys.stdin.readline())
    threading.Thread(target=_end_with_the_supervisor, daemon=True).start()
    _say(channel, do(unit, lambda share: _say(channel, Progress(share=share))))


def do(unit: AnyUnit, progress: Callable[[float], None]) -> Finished | Failed:
    """Do a unit, and say what came of it in the words of the protocol."""
    try:
        unit.run(progress)
    except InputError as error:
        return Failed(error="input", text=str(error))
    except EnvironmentLacking as error:
        return Failed(error="environment", text=str(error))
    except RunFailed as error:
        return Failed(error="run", text=str(error))
    except Exception as error:  # noqa: BLE001 - reported with its traceback by the supervisor, which decides
        if told := lacking(error):
            return Failed(error="environment", text=told)
        return Failed(error="bug", text=traceback.format_exc())
    return Finished()


def _say(channel: TextIO, message: Message) -> None:
    channel.write(message.model_dump_json() + "\n")
    channel.flush()


def _end_with_the_supervisor() -> None:
    sys.stdin.read()
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    main()
