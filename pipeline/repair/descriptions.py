"""Files that follow from the metadata: specifications of runs, description, bag-info.txt."""

from collections.abc import Iterable, Mapping, Sequence

from pydantic import ValidationError

from configs.draw import draw_run
from configs.loader import LoadedScenario, load_resolved
from configs.schema.scenario import SceneSpec
from pipeline.assembly.description import markdown
from pipeline.repair.repair_state import RepairState, with_one_bit_flipped
from pipeline.run_folder.stored_spec import parse_spec
from pipeline.stages.annotate import processors
from pipeline.stages.simulate_runs import SPEC, read_outcome, spec_text
from pipeline.work.processors import cpu_class
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.bag import BAG_INFO, bag_info, read_cpu_classes
from symolo.dataset.documents.metadata import METADATA, Metadata
from symolo.dataset.layout import DESCRIPTION, SIDE

TAKEN = "its trajectory was not simulated here; the command that took it, with the same files, makes it again"
"""Reason why a file of a run that was imported or rendered again cannot be restored."""


def flip_back(state: RepairState, names: Iterable[str]) -> None:
    """Restore the files in which a single bit is wrong; this needs no source."""
    for name in sorted(set(names) & state.wanted.keys()):
        try:
            data = read_file(state.out / name, FileKind.ANY)
        except OSError:
            continue
        if (repaired := with_one_bit_flipped(data, state.wanted[name])) is not None:
            state.put(name, repaired, "one bit was wrong")


def read_metadata(state: RepairState) -> Metadata | None:
    """Return the metadata of the release once its file is restored."""
    data = state.read(METADATA)
    if data is None:
        return None
    try:
        return Metadata.model_validate_json(data)
    except ValidationError:
        return None


def make_specs(state: RepairState, metadata: Metadata | None, runs: Iterable[str]) -> dict[str, SceneSpec]:
    """Return the specifications of these runs; draw the damaged ones again and restore them."""
    specs: dict[str, SceneSpec] = {}
    scenario: LoadedScenario | None = None
    taken = {record.run for record in metadata.runs if record.origin} if metadata else set()
    for run in dict.fromkeys(runs):
        name = f"{run}/{SIDE}/{SPEC}"
        if name in state.wanted and run in taken:
            state.tried[name] = TAKEN
        elif name in state.wanted and metadata is not None:
            try:
                scenario = scenario or load_resolved(metadata.scenario, METADATA)
                route, _, number = run.partition("/test_")
                state.put(
                    name,
                    spec_text(draw_run(scenario, route, int(number))),
                    "drawn again",
                    "drawn again, it is different",
                )
            except (InputError, ValueError) as error:
                state.tried[name] = f"cannot be drawn again: {error}"
        if name in state.wanted:
            flip_back(state, (name,))
        if (data := state.read(name)) is not None:
            try:
                specs[run] = parse_spec(data)
            except ValidationError:
                state.tried[name] = "has the format of a different version"
    return specs


def write_description(state: RepairState, metadata: Metadata | None, excuse: str) -> None:
    if DESCRIPTION not in state.wanted or metadata is None:
        return
    first = metadata.runs[0].run
    if spec := make_specs(state, metadata, (first,)).get(first):
        state.put(DESCRIPTION, markdown(metadata, spec), f"written again from {METADATA}", excuse)


def write_bag_info(state: RepairState, metadata: Metadata | None) -> None:
    """Write bag-info.txt after all other files, because it counts their bytes."""
    if BAG_INFO not in state.wanted or metadata is None or len(state.wanted) > 1:
        return
    sizes = {name: (state.out / name).stat().st_size for name in state.inventory.expected if name != BAG_INFO}
    for cpus in (_noted(state, metadata), read_cpu_classes(state.out), (cpu_class(),), ()):
        info = bag_info(metadata.name, metadata.description, sizes, cpus)
        if state.put(BAG_INFO, info, "written again", "the class of the processor that it named is not known"):
            return


def _noted(state: RepairState, metadata: Metadata) -> set[str]:
    """Return the classes of the processors that the stages have noted."""
    cpus: set[str] = set()
    for record in metadata.runs:
        try:
            cpus.add(read_outcome(state.workspace.simulate(record.run).path).cpu)
            annotated = {"": bool(record.annotations)}
            annotated |= {name: bool(camera.annotations) for name, camera in record.cameras.items()}
            cpus |= {*processors(state.workspace, record.run, annotated)}
        except (OSError, ValueError, KeyError):
            return set()
    return cpus


def differences(state: RepairState, metadata: Metadata | None, made_here: Mapping[str, str]) -> str:
    """Return how this machine differs from that of the release, or that it is not known to."""
    there = read_cpu_classes(state.out) if BAG_INFO not in state.wanted else ()
    known = machine_differences(metadata.made_with if metadata else {}, there, made_here)
    return known or "no difference of programs or processor is known"


def machine_differences(made_there: Mapping[str, str], cpus_there: Sequence[str], made_here: Mapping[str, str]) -> str:
    """Return which programs and processor of this machine are not those of a release; empty where all are.

    Args:
        made_there: Version by program that made the release.
        cpus_there: Classes of the processors that made it; empty where they are not known.
        made_here: Version by program on this machine.
    """
    texts = []
    for program, version in made_there.items():
        if made_here.get(program) != version:
            texts.append(
                f"the release was made with {program} {version}, here it is {made_here.get(program, 'missing')}"
            )
    if cpus_there and tuple(cpus_there) != (cpu_class(),):
        texts.append(f"the release was made on {' and '.join(cpus_there)}, and this is {cpu_class()}")
    return "; ".join(texts)
