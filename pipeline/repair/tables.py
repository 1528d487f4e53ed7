"""Tables of a run, from the stored trajectory or from a new simulation."""

import contextlib
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from zipfile import BadZipFile

from configs.schema.scenario import RunSpec
from pipeline.executors.local import Local
from pipeline.repair.repair_state import RepairState, RepairTools
from pipeline.stages.render import IMAGES
from pipeline.stages.run_tables import tables
from pipeline.stages.simulate_runs import read_recording, simulation_key
from pipeline.work.unit_progress import report_event
from pipeline.work.units import SimulateUnit
from symolo.core.time_series import Recording
from symolo.dataset.layout import ANNOTATIONS, camera_and_file

BY_FRAME = (f"{IMAGES}/", f"{ANNOTATIONS}/")


def make_tables(state: RepairState, specs: Mapping[str, RunSpec], tools: RepairTools) -> None:
    """Restore data.csv, positions and side tables of the runs whose specifications are known."""
    for run, spec in specs.items():
        if _damaged_tables(state, run):
            with contextlib.suppress(OSError, ValueError, KeyError, BadZipFile):
                _put(state, spec, read_recording(state.workspace.simulate(run).path), "from the trajectory", "")
    lost = [spec for run, spec in specs.items() if _damaged_tables(state, run)]
    for spec, folder in zip(lost, _simulate(lost, tools), strict=True):
        try:
            recording = read_recording(folder)
        except OSError:
            for inner in _damaged_tables(state, spec.key):
                state.tried[f"{spec.key}/{inner}"] = "the run cannot be simulated again"
        else:
            _put(state, spec, recording, "simulated again", tools.excuse(spec.key))


def _damaged_tables(state: RepairState, run: str) -> set[str]:
    """Return the damaged files of the run that follow from its trajectory."""
    return {inner for inner in state.runs().get(run, set()) if not camera_and_file(inner)[1].startswith(BY_FRAME)}


def _put(state: RepairState, spec: RunSpec, recording: Recording, how: str, excuse: str) -> None:
    for inner, data in tables(spec, recording):
        state.put(f"{spec.key}/{inner}", data, how, excuse)


def _simulate(specs: Sequence[RunSpec], tools: RepairTools) -> list[Path]:
    """Simulate these runs again and return their folders, which are empty where a run failed."""
    folders = [tools.scratch / "simulate" / spec.key for spec in specs]
    units = [
        SimulateUnit(name=spec.key, spec=spec.model_dump_json(), folder=folder, key=simulation_key(spec))
        for spec, folder in zip(specs, folders, strict=True)
    ]
    if not units:
        return []
    with tools.report.stage("simulate", len(units), "runs") as stage:
        Local(tools.workers).do(units, partial(report_event, stage))
    return folders
