"""The result of `symolo doctor --json`."""

from pipeline.doctor import MachineCheck
from pipeline.json_results.base import JsonPart, JsonResult


class CheckPart(JsonPart):
    """Result of one check of the machine."""

    name: str
    """What was checked."""
    ok: bool
    """Whether it is as it should be."""
    result: str
    """What was there, such as a version."""
    cure: str
    """What to do if it is missing; empty if nothing is to be done."""

    @classmethod
    def from_check(cls, check: MachineCheck) -> "CheckPart":
        return cls(name=check.name, ok=check.ok, result=check.result, cure="" if check.ok else check.cure)


class DoctorResult(JsonResult):
    """Whether this machine has what symolo needs."""

    command: str = "doctor"
    """Name of the command."""
    checks: list[CheckPart]
    """All checks in their order."""
