"""A Ray cluster: each unit is a task on one of its nodes, with a supervisor of its own (https://docs.ray.io).

All nodes see the output folder under the same path, and have this program with its packages. A worker or a node that
dies takes no other with it: Ray gives its task to another one, which keeps the frames that are in place. Nothing comes
back but a short record.
"""

import contextlib
import importlib
import os
import socket
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict
from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind
from pipeline.executors.base import Executor, OnEvent
from pipeline.executors.part import BLOCK_FRAMES
from pipeline.work.supervisor import AnyEvent, FrameGivenUp, Retried, UnitFailure, WorkerError, run_units
from pipeline.work.units import UNITS, AnyUnit, RenderUnit
from pipeline.work.worker_process import WorkerLimits
from symolo.core.child_process import Finished
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.extras import how_to_install

CURE = how_to_install("cluster")
CLIENT = "ray://"
REACHED_WITHIN_S = 10.0
OWN_SETTINGS = {
    "RAY_USAGE_STATS_ENABLED": "0",  # it would report each start to its makers
    # Time to wait for a host that has lost its network, when a task is to be placed on it: as long as the cluster takes
    # to declare the host dead, in place of two minutes (https://github.com/ray-project/ray/pull/44692).
    "RAY_grpc_client_keepalive_timeout_ms": "60000",
}
"""Environment variables of Ray in this process, unless the user has set them; Ray reads them when it is loaded."""
QUEUED = 2
"""Number of tasks in the cluster for each that it can do at a time, so that no node waits."""
CARD_SHARE = 0.5
"""Two processes share a graphics card: while one builds a scene or writes, the other one renders."""
NODES_TRIED = 3
"""Number of nodes that may report something missing before the command gives up."""


class UnitRecord(BaseModel):
    """The result of a unit, as plain JSON."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    failures: tuple[str, ...] = ()
    """Failures of the unit or of its frames."""
    retried: tuple[str, ...] = ()
    error: Literal["", "input", "environment", "bug"] = ""
    """Kind of an error that ends the command, or this try on this node."""
    text: str = ""


@dataclass(frozen=True)
class OnRay(Executor):
    """Tasks on a Ray cluster."""

    address: str
    """Address of the cluster for `ray.init`: `auto`, `HOST:PORT` or `ray://HOST:PORT`."""
    limits: WorkerLimits
    """Limits of each worker."""
    cores: int = 1
    """Number of cores that a unit uses on its node."""
    card_share: float = CARD_SHARE
    """Share of a graphics card that a block uses on its node."""
    device: DeviceKind = "CPU"

    def check(self) -> None:
        _ray()
        host, colon, port = self.address.removeprefix(CLIENT).rpartition(":")
        if not colon:
            return  # `auto`, which Ray looks up on this machine
        # Ray itself would try for minutes.
        try:
            socket.create_connection((host, int(port)), timeout=REACHED_WITHIN_S).close()
        except (OSError, ValueError) as error:
            raise _no_cluster(self.address, error) from None

    def on(self, device: DeviceKind) -> Self:
        return replace(self, device=device)

    def block_frames(self, frames: int, runs: int) -> int:
        del frames, runs
        return BLOCK_FRAMES

    def threads(self, units: int) -> int:
        del units
        return self.cores

    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        ray = _ray()
        with _connected(ray, self.address):
            return _Tasks(ray, self, list(units), on_event).done()


class _Tasks:
    """Units under way in the cluster; their number keeps all nodes busy."""

    def __init__(self, ray: ModuleType, executor: OnRay, units: list[AnyUnit], on_event: OnEvent) -> None:
        self._ray = ray
        self._limits = executor.limits
        self._needs: dict[str, float] = {"CPU": executor.cores}
        options: dict[str, float] = {"num_cpus": executor.cores, "max_retries": executor.limits.tries - 1}
        if executor.device != "CPU":
            _check_cards(ray)
            if any(isinstance(unit, RenderUnit) for unit in units):
                self._needs["GPU"] = options["num_gpus"] = executor.card_share
        self._remote = ray.remote(**options)(done_here)
        self._waiting = units[::-1]
        self._running: dict[Any, AnyUnit] = {}
        self._lacking: Counter[str] = Counter()
        self._on_event = on_event
        self._failures: list[UnitFailure] = []
        self._bugs: list[str] = []

    def done(self) -> list[UnitFailure]:
        try:
            while self._waiting or self._running:
                self._fill()
                ready, _ = self._ray.wait(list(self._running), num_returns=1)
                for reference in ready:
                    self._take(self._running.pop(reference), self._record(reference))
        except BaseException:
            for reference in self._running:
                with contextlib.suppress(Exception):  # what matters is why we stop
                    self._ray.cancel(reference, force=True)
            raise
        if self._bugs:
            raise WorkerError("\n".join(self._bugs))
        return self._failures

    def _fill(self) -> None:
        """Start further tasks. Nodes come and go, so the size of the cluster is read each time."""
        there = self._ray.cluster_resources()
        slots = min(int(there.get(name, 0) / needed) for name, needed in self._needs.items())
        while self._waiting and len(self._running) < QUEUED * max(1, slots):
            unit = self._waiting.pop()
            limits = self._limits
            reference = self._remote.remote(unit.model_dump_json(), limits.tries, limits.silence_s, limits.memory_bytes)
            self._running[reference] = unit

    def _record(self, reference: Any) -> UnitRecord:  # noqa: ANN401 - Ray's
        try:
            return UnitRecord.model_validate_json(self._ray.get(reference))
        except self._ray.exceptions.RayTaskError as error:
            return UnitRecord(error="bug", text=str(error))
        except self._ray.exceptions.RayError as error:
            text = f"given up: {type(error).__name__}: {str(error).splitlines()[0]}"
            return UnitRecord(failures=(f"{text}; the same command tries it again",))

    def _take(self, unit: AnyUnit, record: UnitRecord) -> None:
        for text in record.retried:
            self._on_event(unit, Retried(text))
        if record.error == "input":
            raise InputError(record.text)
        if record.error == "environment":
            self._lacking[unit.name] += 1
            if self._lacking.total() >= NODES_TRIED:
                raise EnvironmentLacking(record.text)
            self._on_event(unit, Retried(f"{unit.name}: {record.text}; trying again, possibly on a different node"))
            self._waiting.insert(0, unit)
            return
        if record.error == "bug":
            self._bugs.append(f"{unit.name}: {record.text}")
        for text in record.failures:
            self._on_event(unit, FrameGivenUp(text))
            self._failures.append(UnitFailure(unit, text))
        self._on_event(unit, Finished())


def done_here(unit_json: str, tries: int, silence_s: float, memory_bytes: int) -> str:
    """Do a unit on this node, in a child process that is watched and tried again as on one machine."""
    unit = UNITS.validate_json(unit_json)
    retried: list[str] = []

    def note(_unit: AnyUnit, event: AnyEvent) -> None:
        if isinstance(event, Retried):
            retried.append(event.text)

    record = UnitRecord()
    try:
        failures = run_units([unit], 1, note, limits=WorkerLimits(tries, silence_s, memory_bytes))
        record = UnitRecord(failures=tuple(failure.text for failure in failures))
    except InputError as error:
        record = UnitRecord(error="input", text=str(error))
    except EnvironmentLacking as error:
        record = UnitRecord(error="environment", text=str(error))
    except WorkerError as error:
        record = UnitRecord(error="bug", text=str(error))
    return record.model_copy(update={"retried": tuple(retried)}).model_dump_json()


def _check_cards(ray: ModuleType) -> None:
    """Check that there is a graphics card; Ray would wait for one for ever."""
    if not ray.cluster_resources().get("GPU", 0):
        cure = "start nodes that have one with `ray start --num-gpus 1`, or give --device cpu"
        raise EnvironmentLacking(f"no node of the cluster has a graphics card, as Ray counts them; {cure}")


def _ray() -> ModuleType:
    for name, value in OWN_SETTINGS.items():
        os.environ.setdefault(name, value)
    try:
        return importlib.import_module("ray")  # an extra, which type checks go without
    except ImportError as error:
        raise EnvironmentLacking(f"Ray cannot be loaded: {error}; {CURE}") from None


def _no_cluster(address: str, error: Exception) -> EnvironmentLacking:
    cause = (str(error).strip().splitlines() or [type(error).__name__])[0]
    cure = "start a cluster with `ray start --head`, and give its address as HOST:PORT"
    return EnvironmentLacking(f"--address {address}: no Ray cluster: {cause}; {cure}")


@contextlib.contextmanager
def _connected(ray: ModuleType, address: str) -> Iterator[None]:
    try:
        ray.init(address=address, log_to_driver=False, logging_level="error")
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise _no_cluster(address, error) from None
    try:
        yield
    finally:
        ray.shutdown()
