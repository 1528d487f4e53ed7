"""`symolo schema`: prints JSON Schemas of scenarios, of metadata.json and of results."""

from typing import Annotated

import typer

from symolo.core.text_enum import TextEnum


class SchemaOf(TextEnum):
    """The kinds of JSON and YAML that have a schema."""

    SCENARIO = "scenario"
    METADATA = "metadata"
    STATUS = "status"
    VERIFY = "verify"
    COMPARE = "compare"
    PLAN = "plan"
    RELEASE = "release"
    BASELINES = "baselines"
    EXPORT = "export"
    DOCTOR = "doctor"
    INSPECT = "inspect"


def schema(
    of: Annotated[
        SchemaOf,
        typer.Option(
            "--of",
            help="scenario: scenario files; metadata: metadata.json of a dataset; the others: what the command of "
            "this name prints with --json.",
        ),
    ] = SchemaOf.SCENARIO,
) -> None:
    """Print a JSON Schema: of scenario files, of metadata.json, or of the results that commands print with --json.

    Editors use the first two to check and complete such files.

    Example: symolo schema > scenario.schema.json

    Example: symolo schema --of verify > verify.schema.json
    """
    import json

    from configs.validation.json_schema import scenario_json_schema
    from pipeline.json_results import result_json_schema
    from symolo.dataset.documents.metadata_schema import metadata_json_schema

    match of:
        case SchemaOf.SCENARIO:
            document = scenario_json_schema()
        case SchemaOf.METADATA:
            document = metadata_json_schema()
        case _:
            document = result_json_schema(of.value)
    typer.echo(json.dumps(document, indent=2, ensure_ascii=False))
