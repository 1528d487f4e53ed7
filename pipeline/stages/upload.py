"""Upload of a release while it is made: each run as soon as it is complete, the lists of checksums at the end.

Threads assemble and send the runs, so that nothing waits for the network. A failed upload is reported,
and the release itself is the same as without an upload.
"""

import contextlib
import hashlib
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from pydantic import ValidationError

from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import release_run
from pipeline.stages.simulate_runs import spec_text
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files.file_hashes import canonical_json
from symolo.core.os_errors import lacking
from symolo.core.progress import Report, plural
from symolo.dataset.bag import BAG_INFO
from symolo.dataset.documents.metadata import METADATA, Metadata, made_with
from symolo.dataset.layout import DESCRIPTION, SIDE, SPEC
from symolo.dataset.manifest import SEALS
from symolo.storage.base import LocalFile, Store
from symolo.storage.comparison import compare_listed, digest_of, released_files
from symolo.storage.side_by_side import side_by_side
from symolo.storage.upload import another_release, check_apart, refuse_extra, send
from symolo.verification.inventory import LISTS

AT_THE_TOP = frozenset({*LISTS, *SEALS, BAG_INFO, METADATA, DESCRIPTION})


@dataclass(frozen=True)
class Destination:
    """The store to which a release is uploaded while it is made, and the command that sends the missing files."""

    store: Store
    command: str

    @contextlib.contextmanager
    def opened(
        self, workspace: Workspace, tree: dict[str, Any], specs: Sequence[RunSpec], report: Report
    ) -> Iterator["ReleaseUpload"]:
        """Lock the destination while the release is made.

        Raises:
            InputError: It holds something else, or lies within the release.
            EnvironmentLacking: It cannot be reached.
        """
        check_apart(workspace.out, self.store)
        with self.store.locked():
            upload = ReleaseUpload(workspace, self, _listed(self.store, tree, specs), report)
            try:
                yield upload
            finally:
                upload.stop()


def _listed(store: Store, tree: dict[str, Any], specs: Sequence[RunSpec]) -> dict[str, int]:
    """Return the sizes of the files at the destination, which must all belong to this release by name, specification
    and metadata.
    """
    sizes = store.sizes()
    runs = {spec.key for spec in specs}
    for name in sorted(sizes.keys() - AT_THE_TOP):
        if "/".join(PurePosixPath(name).parts[:2]) not in runs:
            raise another_release(store, f"{name} does not belong to a run of this scenario")
    expected = {f"{spec.key}/{SIDE}/{SPEC}": hashlib.sha256(spec_text(spec)).hexdigest() for spec in specs}
    there = [name for name in expected if name in sizes]
    for name, digest in side_by_side(lambda name: digest_of(store, name), there):
        if digest not in {expected[name], ""}:
            raise another_release(store, f"{name} is not that of this scenario")
    if METADATA in sizes:
        _check_metadata(store, tree)
    return sizes


def _check_metadata(store: Store, tree: dict[str, Any]) -> None:
    try:
        metadata = Metadata.model_validate_json(store.get(METADATA) or b"")
    except ValidationError:
        raise another_release(store, f"{METADATA} is not of this version") from None
    if canonical_json(metadata.scenario) != canonical_json(tree):
        raise another_release(store, f"{METADATA} names a different scenario")
    if metadata.made_with != made_with():
        raise another_release(store, "it was made with different versions")


class ReleaseUpload:
    """The upload of a release. One thread calls `run_done` and `finish`."""

    def __init__(self, workspace: Workspace, to: Destination, sizes: Mapping[str, int], report: Report) -> None:
        self._workspace, self._to, self._sizes, self._report = workspace, to, sizes, report
        self._assembling, self._sending = ThreadPoolExecutor(1), ThreadPoolExecutor(1)
        self._sends: list[Future[None]] = []
        self._over = threading.Event()
        self._known: dict[str, str] = {}
        self._sent = 0

    def run_done(self, spec: SceneSpec) -> None:
        """Assemble and send a run that has all its files, while other runs are made."""
        # A finished release there is compared at the end; nothing of it is replaced before.
        if not self._sizes.keys() & {*LISTS}:
            self._assembling.submit(self._assemble, spec)

    def assembled(self) -> None:
        """Wait until every complete run is assembled, so that only the caller works in the folder."""
        self._assembling.shutdown(wait=True)

    def finish(self, *, complete: bool) -> str:
        """Send the rest and the lists of checksums, and return a message about it.

        Args:
            complete: Whether no run failed; else the copy is not finished, because the next release will differ.

        Raises:
            InputError: The destination holds something else now, or a file of the release changed.
            EnvironmentLacking: It cannot be reached.
        """
        self._sending.shutdown(wait=True)
        for future in self._sends:
            future.result()
        url = self._to.store.url
        if not complete:
            cure = f"the same command continues, or `{self._to.command}` sends the rest as it is"
            return f"{url}: not finished, because a run failed; {cure}"
        with self._with_cure():
            files = released_files(self._workspace.out)
            comparison = send(files, self._to.store, self._report, self._known)
        rest = len(comparison.to_send)
        return f"{url}: {plural(len(files), 'file')} there, {self._sent + rest} sent now, {rest} of them at the end"

    def stop(self) -> None:
        """Wait for running transfers, and begin no more."""
        self._over.set()
        self._assembling.shutdown(wait=True, cancel_futures=True)
        self._sending.shutdown(wait=True, cancel_futures=True)

    def _assemble(self, spec: SceneSpec) -> None:
        # An error here occurs again, and is reported, when the release is assembled.
        hashes = release_run(self._workspace, spec)
        out = self._workspace.out
        files = [_local(out, f"{spec.key}/{name}", digest) for name, digest in hashes.items()]
        self._sends.append(self._sending.submit(self._send, spec.key, files))

    def _send(self, run: str, files: Sequence[LocalFile]) -> None:
        if self._over.is_set():
            return
        sizes = {name: size for name, size in self._sizes.items() if name.startswith(f"{run}/")}
        try:
            self._send_files(run, files, sizes)
        except (InputError, EnvironmentLacking, OSError) as error:
            self._over.set()
            self._report.say(f"upload: {run}: {error}; the release continues, and the rest is sent at its end")

    def _send_files(self, run: str, files: Sequence[LocalFile], sizes: Mapping[str, int]) -> None:
        store = self._to.store
        comparison = compare_listed(files, sizes, store)
        refuse_extra(comparison, store)
        self._known |= {file.name: file.digest for file in comparison.same}
        done, size = 0, 0
        with contextlib.closing(side_by_side(store.put, comparison.to_send)) as sent:
            for file, _ in sent:
                self._known[file.name] = file.digest
                self._sent, done, size = self._sent + 1, done + 1, size + file.size_bytes
                if self._over.is_set():
                    return
        self._report.say(
            f"upload: {run}: {plural(done, 'file')} sent, {size / 1e6:.1f} MB;"
            f" {len(comparison.same)} were already there"
        )

    @contextlib.contextmanager
    def _with_cure(self) -> Iterator[None]:
        """Add to errors that the release itself is complete, and how to continue the upload."""
        cure = f"the release is complete in {self._workspace.out}, and `{self._to.command}` sends what is missing there"
        try:
            yield
        except InputError as error:
            raise InputError(str(error), cure=cure) from None
        except (EnvironmentLacking, OSError) as error:
            cause = str(error) if isinstance(error, EnvironmentLacking) else lacking(error)
            if not cause:
                raise
            raise EnvironmentLacking(f"{cause}; {cure}") from None


def _local(out: Path, name: str, digest: str) -> LocalFile:
    path = out / name
    return LocalFile(name, path, path.stat().st_size, digest)
