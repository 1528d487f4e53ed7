"""Tables of a run, from its first stage or from a new simulation."""

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from zipfile import BadZipFile

from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.executors.local import Local
from pipeline.repair.descriptions import TAKEN
from pipeline.repair.repair_state import RepairState, RepairTools
from pipeline.stages.render import IMAGES
from pipeline.stages.run_tables import stage_tables
from pipeline.stages.simulate_runs import simulation_key
from pipeline.work.unit_progress import report_event
from pipeline.work.units import SimulateUnit
from sensors.build import listed_sensors, with_loaded_sensors
from symolo.core.errors import InputError
from symolo.dataset.documents.metadata import Metadata
from symolo.dataset.layout import ANNOTATIONS, SIDE, camera_and_file

BY_FRAME = (f"{IMAGES}/", f"{ANNOTATIONS}/")


def make_tables(
    state: RepairState, specs: Mapping[str, SceneSpec], metadata: Metadata | None, tools: RepairTools
) -> None:
    """Restore data.csv, positions and side tables of the runs whose specifications are known."""
    for run, spec in specs.items():
        if _damaged_tables(state, run):
            sensors = metadata.listed_sensors if metadata else listed_sensors(with_loaded_sensors(spec.robot)[0])
            made = stage_tables(spec, state.workspace.simulate(run).path, sensors)
            with contextlib.suppress(InputError, OSError, ValueError, KeyError, BadZipFile):
                _put(state, run, made, "from the trajectory", "")
    lost = [spec for run, spec in specs.items() if _damaged_tables(state, run)]
    for spec in lost:
        if spec.origin:
            _explain(state, spec, TAKEN)
    needed = [spec for spec in lost if isinstance(spec, RunSpec) and not spec.origin and _can_act(state, spec)]
    simulated = [loaded for spec in needed if (loaded := _with_loaded_sensors(state, spec))]
    for spec, folder in zip(simulated, _simulate(simulated, tools), strict=True):
        try:
            _put(state, spec.key, stage_tables(spec, folder), "simulated again", tools.excuse(spec.key))
        except OSError:
            _explain(state, spec, "the run cannot be simulated again")


def _can_act(state: RepairState, spec: SceneSpec) -> bool:
    """Return whether the files of the effects are loaded, and note why not: the code of a dataset is not executed."""
    try:
        spec.robot.effects.require_loaded()
    except InputError as error:
        _explain(state, spec, str(error))
        return False
    return True


def _with_loaded_sensors(state: RepairState, spec: RunSpec) -> RunSpec | None:
    """Return the run without sensors whose files are not loaded, and note why these have no readings.

    They change no other reading, and each file must have its checksum. None if nothing else is damaged.
    """
    robot, problems = with_loaded_sensors(spec.robot)
    tables = {f"{SIDE}/{name}.csv": problem for name, problem in problems.items()}
    damaged = _damaged_tables(state, spec.key)
    state.tried |= {f"{spec.key}/{inner}": str(tables[inner]) for inner in damaged & tables.keys()}
    return spec.model_copy(update={"robot": robot}) if damaged - tables.keys() else None


def _damaged_tables(state: RepairState, run: str) -> set[str]:
    """Return the damaged files of the run that follow from its trajectory."""
    return {inner for inner in state.runs().get(run, set()) if not camera_and_file(inner)[1].startswith(BY_FRAME)}


def _explain(state: RepairState, spec: SceneSpec, reason: str) -> None:
    """Note why the damaged tables of a run are not restored."""
    for inner in _damaged_tables(state, spec.key):
        state.tried[f"{spec.key}/{inner}"] = reason


def _put(state: RepairState, run: str, tables: Iterable[tuple[str, bytes]], how: str, excuse: str) -> None:
    """Restore tables of a run, which are made one by one."""
    for inner, data in tables:
        state.put(f"{run}/{inner}", data, how, excuse)


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
