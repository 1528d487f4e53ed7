"""Specifications of runs, description, bag-info.txt: what follows from the metadata."""

from collections.abc import Iterable, Mapping

from pydantic import ValidationError

from configs.draw import draw_run
from configs.loader import LoadedScenario, load_resolved
from configs.schema.scenario import RunSpec
from pipeline.assembly.description import markdown
from pipeline.repair.mending import Mending, with_one_bit_less_wrong
from pipeline.stages.annotate import processors
from pipeline.stages.assemble import SIDE
from pipeline.stages.simulate_runs import SPEC, read_outcome, spec_text
from pipeline.work.cpu import cpu_class
from symolo.core.errors import InputError
from symolo.dataset.bag import BAG_INFO, bag_info, read_cpu_classes
from symolo.dataset.layout import DESCRIPTION
from symolo.dataset.metadata import METADATA, Metadata


def flip_back(mending: Mending, names: Iterable[str]) -> None:
    """Restore the files in which a single bit is wrong, for which no source is needed."""
    for name in sorted(set(names) & mending.wanted.keys()):
        try:
            data = (mending.out / name).read_bytes()
        except OSError:
            continue
        if (right := with_one_bit_less_wrong(data, mending.wanted[name])) is not None:
            mending.put(name, right, "one bit was wrong")


def read_metadata(mending: Mending) -> Metadata | None:
    """That of the release, once it is whole."""
    data = mending.read(METADATA)
    if data is None:
        return None
    try:
        return Metadata.model_validate_json(data)
    except ValidationError:
        return None


def make_specs(mending: Mending, metadata: Metadata | None, runs: Iterable[str]) -> dict[str, RunSpec]:
    """Specifications of these runs, of which the damaged ones are drawn again and restored."""
    found: dict[str, RunSpec] = {}
    scenario: LoadedScenario | None = None
    for run in dict.fromkeys(runs):
        name = f"{run}/{SIDE}/{SPEC}"
        if name in mending.wanted and metadata is not None:
            try:
                scenario = scenario or load_resolved(metadata.scenario, METADATA)
                route, _, number = run.partition("/test_")
                mending.put(name, spec_text(draw_run(scenario, route, int(number))), "drawn again", "drawn otherwise")
            except (InputError, ValueError) as error:
                mending.tried[name] = f"cannot be drawn again: {error}"
        if name in mending.wanted:
            flip_back(mending, (name,))
        if (data := mending.read(name)) is not None:
            try:
                found[run] = RunSpec.model_validate_json(data)
            except ValidationError:
                mending.tried[name] = "is of another version's form"
    return found


def write_description(mending: Mending, metadata: Metadata | None, excuse: str) -> None:
    if DESCRIPTION not in mending.wanted or metadata is None:
        return
    first = metadata.runs[0].run
    if spec := make_specs(mending, metadata, (first,)).get(first):
        mending.put(DESCRIPTION, markdown(metadata, spec), f"written again from {METADATA}", excuse)


def write_bag_info(mending: Mending, metadata: Metadata | None) -> None:
    """After all others, for it counts their bytes."""
    if BAG_INFO not in mending.wanted or metadata is None or len(mending.wanted) > 1:
        return
    sizes = {name: (mending.out / name).stat().st_size for name in mending.inventory.expected if name != BAG_INFO}
    for cpus in (_noted(mending, metadata), read_cpu_classes(mending.out), (cpu_class(),), ()):
        info = bag_info(metadata.name, metadata.description, sizes, cpus)
        if mending.put(BAG_INFO, info, "written again", "the class of the processor that it told is not known"):
            return


def _noted(mending: Mending, metadata: Metadata) -> set[str]:
    """Processors as the stages know them."""
    cpus: set[str] = set()
    for record in metadata.runs:
        try:
            cpus.add(read_outcome(mending.workspace.simulate(record.run).path).cpu)
            annotate = mending.workspace.annotate(record.run) if record.annotations else None
            cpus |= {*processors(mending.workspace.render(record.run), annotate)}
        except (OSError, ValueError, KeyError):
            return set()
    return cpus


def differences(mending: Mending, metadata: Metadata | None, made_here: Mapping[str, str]) -> str:
    """What made the release and is not here: programs of other versions, another processor."""
    told = []
    for program, version in (metadata.made_with if metadata else {}).items():
        if made_here.get(program) != version:
            told.append(f"{program} {version} made it and here is {made_here.get(program, 'none')}")
    there = read_cpu_classes(mending.out) if BAG_INFO not in mending.wanted else ()
    if there and there != (cpu_class(),):
        told.append(f"it was made on {' and '.join(there)}, and this is {cpu_class()}")
    return "; ".join(told) or "neither its programs nor its processor are known to differ"
