"""The file format of Rerun recordings, .rrd, written here because Rerun's writer never gives the same bytes twice.

We tried its writers on the same data. rerun-sdk 0.23.1, the last version for numpy 1, makes the ids of chunks and rows
from the clock and a random generator, in `log` and in `send_columns`. rerun-sdk 0.41.0, which needs numpy 2 and Python
3.11, accepts our ids in `Chunk.from_record_batch`, but `write_rrd` writes the time into the message on the recording.

We write the format of Rerun 0.23 without compression, which later versions can read: a head, then messages, each with
its kind and length. A chunk is a table of Arrow in a message of Protobuf (crates re_log_encoding, re_protos and
re_chunk of https://github.com/rerun-io/rerun/tree/0.23.1/crates/store).
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from types import ModuleType
from typing import Any

from symolo.core.arrays import Array

Arrays = Any
"""Array of pyarrow, which is loaded only for an export."""

_VERSION = (0, 23, 1)
_HEAD = struct.pack("<4s4B4B", b"RRF2", *_VERSION, 0, 1, 2, 0, 0)
_STORE_INFO, _ARROW, _END = 1, 2, 0
_RECORDING, _ARROW_IPC, _OTHER = 1, 1, 6
_ROW_ID = {
    "rerun.kind": "control",
    "rerun.is_sorted": "true",
    "ARROW:extension:name": "rerun.datatypes.TUID",
    "ARROW:extension:metadata": '{"namespace":"row"}',
}
TIMELINE = "t"
"""Name of the timeline: time [s] since the start of the run."""


@dataclass(frozen=True)
class Component:
    """One field of an archetype, such as `translation` of Transform3D."""

    field: str
    name: str
    values: Arrays
    """List array with one list for each row; an empty list removes the value of the previous rows."""


@dataclass(frozen=True)
class Chunk:
    """The components of an entity, at given times or for the whole recording."""

    path: str
    """Path of the entity, for example `/world/robot`."""
    archetype: str
    components: tuple[Component, ...]
    t_s: Array | None = None
    """(N,), strictly increasing times [s]; None for one row that holds for the whole recording."""


def rrd(arrow: ModuleType, recording: str, chunks: Sequence[Chunk]) -> bytes:
    """Return the bytes of a file; the same chunks give the same bytes.

    Args:
        arrow: The module pyarrow.
        recording: Identifier of the recording; the viewer shows files with the same identifier together.
        chunks: Chunks in their order in the file.
    """
    numbers = count(1)
    messages = [_HEAD, _message(_STORE_INFO, _store_info(recording, next(numbers)))]
    for chunk in chunks:
        batch = _batch(arrow, chunk, numbers)
        sink = arrow.BufferOutputStream()
        with arrow.ipc.new_stream(sink, batch.schema) as writer:
            writer.write_batch(batch)
        payload = sink.getvalue().to_pybytes()
        body = _bytes(1, _store_id(recording)) + _number(2, 1) + _number(3, len(payload)) + _number(4, _ARROW_IPC)
        messages.append(_message(_ARROW, body + _bytes(5, payload)))
    return b"".join([*messages, _message(_END, b"")])


def _batch(arrow: ModuleType, chunk: Chunk, numbers: "count[int]") -> Arrays:
    """Return the table of a chunk, whose ids are the next numbers; Rerun's writer has random ones with the time."""
    rows = len(chunk.components[0].values)
    chunk_id = next(numbers)
    row_ids = arrow.array([struct.pack(">QQ", 1, next(numbers)) for _ in range(rows)], arrow.binary(16))
    columns = [(arrow.field("rerun.controls.RowId", row_ids.type, nullable=False, metadata=_ROW_ID), row_ids)]
    if chunk.t_s is not None:
        times = arrow.array((chunk.t_s * 1e9).round().astype("int64"), arrow.duration("ns"))
        metadata = {"rerun.kind": "index", "rerun.index_name": TIMELINE, "rerun.is_sorted": "true"}
        columns.append((arrow.field(TIMELINE, times.type, metadata=metadata), times))
    for one in chunk.components:
        metadata = {
            "rerun.archetype": f"rerun.archetypes.{chunk.archetype}",
            "rerun.archetype_field": one.field,
            "rerun.kind": "data",
            "rerun.component": f"rerun.components.{one.name}",
        }
        columns.append((arrow.field(one.name, one.values.type, metadata=metadata), one.values))
    # The viewer of 0.23 recognises an archetype by its indicator, a component without values.
    indicator = f"{chunk.archetype}Indicator"
    nothing = arrow.array([[None]] * rows, arrow.list_(arrow.null()))
    metadata = {"rerun.kind": "data", "rerun.component": f"rerun.components.{indicator}"}
    columns.append((arrow.field(indicator, nothing.type, metadata=metadata), nothing))
    head = {
        "rerun.version": "1",
        "rerun.id": f"chunk_{1:016X}{chunk_id:016x}",
        "rerun.entity_path": chunk.path,
        "rerun.heap_size_bytes": str(sum(values.nbytes for _, values in columns)),
    }
    schema = arrow.schema([field for field, _ in columns], metadata=head)
    return arrow.RecordBatch.from_arrays([values for _, values in columns], schema=schema)


def _store_info(recording: str, number: int) -> bytes:
    row_id = struct.pack("<BQBQ", 1 << 3 | 1, 1, 2 << 3 | 1, number)
    version = _number(1, int.from_bytes((*_VERSION, 0), "little"))
    source = _number(1, _OTHER) + _bytes(2, _bytes(1, b"symolo"))
    info = _bytes(1, _bytes(1, b"symolo")) + _bytes(2, _store_id(recording)) + _bytes(5, source) + _bytes(6, version)
    return _bytes(1, row_id) + _bytes(2, info)


def _store_id(recording: str) -> bytes:
    return _number(1, _RECORDING) + _bytes(2, recording.encode())


def _message(kind: int, body: bytes) -> bytes:
    return struct.pack("<QQ", kind, len(body)) + body


# Fields of Protobuf, https://protobuf.dev/programming-guides/encoding


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _bytes(field: int, value: bytes) -> bytes:
    return _varint(field << 3 | 2) + _varint(len(value)) + value


def _varint(value: int) -> bytes:
    """Return a number in groups of 7 bits, the lowest first; bit 7 shows that another group follows."""
    groups = bytearray()
    while value > 127:
        groups.append(value & 127 | 128)
        value >>= 7
    return bytes((*groups, value))
