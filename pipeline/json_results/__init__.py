"""Results that commands print with `--json`: one object with documented keys, and its JSON Schema."""

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from pipeline.json_results.base import JsonResult
from pipeline.json_results.baselines import BaselinesResult
from pipeline.json_results.compare import CompareResult
from pipeline.json_results.doctor import DoctorResult
from pipeline.json_results.export import ExportResult
from pipeline.json_results.inspect import InspectResult
from pipeline.json_results.plan import PlanResult
from pipeline.json_results.release import ReleaseResult
from pipeline.json_results.status import StatusResult
from pipeline.json_results.verify import VerifyResult
from symolo.core.field_descriptions import DescribedJsonSchema

RESULTS: Mapping[str, type[JsonResult]] = {
    "status": StatusResult,
    "verify": VerifyResult,
    "compare": CompareResult,
    "plan": PlanResult,
    "release": ReleaseResult,
    "baselines": BaselinesResult,
    "export": ExportResult,
    "doctor": DoctorResult,
    "inspect": InspectResult,
}
"""The result of each command by its name."""


def result_json_schema(command: str) -> dict[str, Any]:
    """Return the schema of the result of a command as plain data, draft 2020-12."""
    schema = RESULTS[command].model_json_schema(schema_generator=DescribedJsonSchema, mode="serialization")
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "title": f"symolo {command} --json"}
