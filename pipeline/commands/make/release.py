"""`symolo release`: makes a dataset from a scenario, with all stages."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import (
    Address,
    AllowHttp,
    Endpoint,
    ExecutorName,
    GpuShare,
    Json,
    Like,
    OnDevice,
    Out,
    Replace,
    Scenario,
    Settings,
    WorkedBy,
    WorkerMemory,
    Workers,
    with_device,
    with_like,
)
from pipeline.commands.stages import make
from symolo.core.errors import InputError

if TYPE_CHECKING:
    from pipeline.stages.upload import Destination


STAGES = ("simulate", "render", "assemble")


def release(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    executor: WorkedBy = ExecutorName.LOCAL,
    address: Address = "auto",
    gpu_share: GpuShare = None,
    upload: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Send each run to this address as soon as it is complete, and the lists of checksums at the end: "
            "s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER.",
        ),
    ] = None,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
    replace: Replace = False,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Print what would be lost, made again and kept, and do nothing else.",
        ),
    ] = False,
    as_json: Json = False,
) -> int:
    """Make a dataset from a scenario: simulate, render and assemble.

    Example: symolo release smoke --out data

    The same command continues after an interruption. It repeats only the work whose inputs have changed: after a change
    of the look, it renders again, but does not simulate again.

    What a command with other inputs would do: symolo release smoke --out data --set render.quality=high --dry-run

    With --dry-run --json, the key `up_to_date` states whether there is nothing to do, as far as the settings and the
    names of the files show; `symolo status DIR --check` also hashes the files.

    Robots that agree with a diagnosis, another one in each run: symolo release smoke --like diagnosis --out data

    On a cluster: symolo release symolo --out /shared/data --executor ray --address head:6379

    Upload while it runs: symolo release smoke --out data --upload file:///mnt/shelf/data
    """
    if executor is ExecutorName.RAY and workers is not None:
        raise InputError("--workers", got=workers, cure="leave it out: the size of the cluster decides")
    if executor is not ExecutorName.RAY and gpu_share is not None:
        raise InputError(
            "--gpu-share", got=gpu_share, cure="leave it out: without Ray, workers use the graphics cards alternately"
        )
    if as_json and not dry_run:
        raise InputError("--json is for --dry-run", cure="add --dry-run; metadata.json states what a release has")
    from pipeline.executors import chosen

    cluster = address if executor is ExecutorName.RAY else None
    workplace = chosen(workers, memory, address=cluster, card_share=gpu_share)
    to = _destination(out, upload, endpoint, allow_http=allow_http)
    overrides = with_device(with_like(settings, like), device)
    return make(STAGES, scenario, overrides, out, workplace, to=to, replace=replace, dry_run=dry_run, as_json=as_json)


def _destination(out: Path, url: str | None, endpoint: str | None, *, allow_http: bool) -> "Destination | None":
    if url is None:
        if endpoint or allow_http:
            raise InputError("--endpoint" if endpoint else "--allow-http", cure="name the destination with --upload")
        return None
    from pipeline.stages.upload import Destination
    from symolo.storage.address import store_of

    options = [*(["--endpoint", endpoint] if endpoint else []), *(["--allow-http"] if allow_http else [])]
    command = shlex.join(["symolo", "upload", str(out), url, *options])
    return Destination(store_of(url, endpoint, allow_http=allow_http), command)
