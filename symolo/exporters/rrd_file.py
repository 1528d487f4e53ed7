"""The file form of Rerun recordings, .rrd, written here: Rerun's own writer stamps each row with the day and chance.

In the form of Rerun 0.23 without compression, which later versions read: a head, then messages, each with its kind and
length. A chunk is a table of Arrow in a message of Protobuf (crates re_log_encoding, re_protos and re_chunk of
https://github.com/rerun-io/rerun/tree/0.23.1/crates/store).
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from types import ModuleType
from typing import Any

from symolo.core.arrays import Array

Arrays = Any
"""Of pyarrow, which is loaded when something is exported."""

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
"""Seconds since the start of the run."""


@dataclass(frozen=True)
class Component:
    """One field of an archetype, such as `translation` of Transform3D."""

    field: str
    name: str
    values: Arrays
    """A list array with one list for each row; an empty list takes away what was there before."""


@dataclass(frozen=True)
class Chunk:
    """What an entity is at some times, or always."""

    path: str
    """For example `/world/robot`."""
    archetype: str
    components: tuple[Component, ...]
    t_s: Array | None = None
    """(N,), strictly increasing [s]; None for one row that holds always."""


def rrd(arrow: ModuleType, recording: str, chunks: Sequence[Chunk]) -> bytes:
    """The bytes of a file, the same for the same chunks.

    Args:
        arrow: The module pyarrow.
        recording: Its identity; files of one recording are shown as one.
        chunks: In their order.
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
    """The table of a chunk; rows are numbered on, and the chunk itself, where Rerun's writer has time and chance."""
    rows = len(chunk.components[0].values)
    chunk_id = next(numbers)
    row_ids = arrow.array([struct.pack(">QQ", 1, next(numbers)) for _ in range(rows)], arrow.binary(16))
    columns = [(arrow.field("rerun.controls.RowId", row_ids.type, nullable=False, metadata=_ROW_ID), row_ids)]
    if chunk.t_s is not None:
        times = arrow.array((chunk.t_s * 1e9).round().astype("int64"), arrow.duration("ns"))
        about = {"rerun.kind": "index", "rerun.index_name": TIMELINE, "rerun.is_sorted": "true"}
        columns.append((arrow.field(TIMELINE, times.type, metadata=about), times))
    archetype = f"rerun.archetypes.{chunk.archetype}"
    for one in chunk.components:
        told = {"rerun.archetype": archetype, "rerun.archetype_field": one.field}
        about = told | {"rerun.kind": "data", "rerun.component": f"rerun.components.{one.name}"}
        columns.append((arrow.field(one.name, one.values.type, metadata=about), one.values))
    indicator = f"{chunk.archetype}Indicator"
    marks = arrow.array([[None]] * rows, arrow.list_(arrow.null()))
    about = {"rerun.kind": "data", "rerun.component": f"rerun.components.{indicator}"}
    columns.append((arrow.field(indicator, marks.type, metadata=about), marks))
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
    about = _bytes(1, _bytes(1, b"symolo")) + _bytes(2, _store_id(recording)) + _bytes(5, source) + _bytes(6, version)
    return _bytes(1, row_id) + _bytes(2, about)


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
    made = bytearray()
    while value > 127:
        made.append(value & 127 | 128)
        value >>= 7
    return bytes((*made, value))
