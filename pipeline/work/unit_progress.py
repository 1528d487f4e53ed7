"""Progress of units of work in the report of a stage."""

from pipeline.work.supervisor import AnyEvent, Retried
from pipeline.work.units import AnyUnit, Progress, RenderUnit
from symolo.core.child_process import Finished
from symolo.core.progress import StageReport


def report_event(stage: StageReport, unit: AnyUnit, event: AnyEvent) -> None:
    """Report how far a unit is, in frames of a block or as a share of a run, and each further try."""
    if isinstance(event, Retried):
        stage.say(event.text)
    elif isinstance(event, Progress | Finished):
        share = event.share if isinstance(event, Progress) else 1.0
        if isinstance(unit, RenderUnit):
            stage.update(f"{unit.name} {unit.work} from {unit.numbers[0]}", share * len(unit.numbers))
        else:
            stage.update(unit.name, share)
